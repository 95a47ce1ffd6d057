// SPDX-License-Identifier: BSD-3-Clause
#include "view/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rio/core/chi2.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/pairing.hpp"
#include "view/calibration_names.hpp"
#include "view/report_plots.hpp"

namespace rio::view {

namespace {

constexpr double kRateBin = 0.05;                             // of a radar without a grid [m/s]
constexpr Time kTruthEnds = std::chrono::milliseconds(1500);  // before the estimate does

void set_vector(Columns* columns, const std::string& name, const Vector3d& value,
                const Vector3d& sigma, double scale = 1.0) {
  for (int i = 0; i < 3; ++i) {
    const std::string column = name + "." + kAxes[i];
    columns->set(column, scale * value[i]);
    columns->set("s" + column, scale * sigma[i]);
  }
}

}  // namespace

void ReportBuilder::begin(const RunStart& start) {
  start_ = start;
  page_.title = start.name;
  page_.subtitle = fmt::format("Radar-inertial odometry by rio {}: {}, {} radar{}", start.version,
                               start.options.backend == BackEnd::kEkf ? "filter" : "smoother",
                               start.options.radars(), start.options.radars() > 1 ? "s" : "");
  page_.paths.push_back({"estimate"});
  if (!start.truth.empty()) page_.paths.push_back({"truth"});
  page_.plots = report_plots(start.options.radars());
}

void ReportBuilder::add(const Odometry& odometry) {
  const NavState& x = odometry.at_scan();
  if (!begun_) page_.begin = start_.begin.value_or(x.time);
  begun_ = true;
  last_time_ = x.time;
  const double seconds = to_seconds(x.time - page_.begin);
  page_.columns.start_row(seconds);
  page_.paths.front().add(seconds, x.p_WB, x.q_WB);
  add_state(odometry);
  add_calibration(odometry.report());
  add_models(odometry.report());
  add_points(odometry, seconds);
  add_truth(odometry, seconds);
}

void ReportBuilder::add_state(const Odometry& odometry) {
  Columns& columns = page_.columns;
  const NavState& x = odometry.at_scan();
  const BodyCovariance& covariance = odometry.covariance();
  set_vector(&columns, "p", x.p_WB, sigma_of(covariance, body::kPosition));
  set_vector(&columns, "v", x.v_WB, sigma_of(covariance, body::kVelocity));
  set_vector(&columns, "bg", x.gyro_bias, sigma_of(covariance, body::kGyroBias),
             eval::kDegreesPerRadian);
  set_vector(&columns, "ba", x.accel_bias, sigma_of(covariance, body::kAccelBias));
  columns.set("speed", x.v_WB.norm());
  const Matrix3d R = x.q_WB.toRotationMatrix();
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  yaw_ += std::remainder(yaw - yaw_, 2.0 * std::acos(-1.0));
  // about the horizontal axis of the heading, the one to its left, and the vertical
  const Matrix3d ahead = Eigen::AngleAxisd(-yaw, Vector3d::UnitZ()) * R;
  const Matrix3d P =
      ahead * covariance.block<3, 3>(body::kAttitude, body::kAttitude) * ahead.transpose();
  const auto sigma = [](double variance) {
    return eval::kDegreesPerRadian * std::sqrt(std::max(0.0, variance));
  };
  yaw_sigma_ = sigma(P(2, 2));
  columns.set("a.roll", eval::kDegreesPerRadian * std::atan2(R(2, 1), R(2, 2)));
  columns.set("a.pitch", -eval::kDegreesPerRadian * std::asin(std::clamp(R(2, 0), -1.0, 1.0)));
  columns.set("a.yaw", eval::kDegreesPerRadian * yaw_);
  columns.set("sa.roll", sigma(P(0, 0)));
  columns.set("sa.pitch", sigma(P(1, 1)));
  columns.set("sa.yaw", yaw_sigma_);
}

void ReportBuilder::add_calibration(const UpdateReport& report) {
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const CalibrationReport& c = report.calibration[i];
    if (c.observability == Observability::kNotEstimated) continue;
    calibration_[calibration_name(i, report.radar)] = {kCalibrationNames[i].scale * c.value,
                                                       kCalibrationNames[i].scale * c.sigma};
  }
  for (const auto& [column, correction] : calibration_) {  // of the other radars: unchanged
    page_.columns.set(column, correction.first);
    page_.columns.set("s" + column, correction.second);
  }
}

void ReportBuilder::add_models(const UpdateReport& report) {
  Columns& columns = page_.columns;
  for (std::size_t i = 0; i < kModelCount; ++i) {
    const ModelReport& model = report.models[i];
    const std::string name = to_string(static_cast<Model>(i));
    const bool any = model.rows_used + model.rows_gated > 0;
    if (!any && !columns.has(name + ".used")) continue;
    columns.set(name + ".used", model.rows_used);
    columns.set(name + ".gated", model.rows_gated);
    if (!any) continue;
    double low = 1e300;
    double high = -1e300;
    double sum = 0.0;
    int count = 0;
    for (const InnovationRecord& innovation : report.records) {
      if (static_cast<std::size_t>(innovation.model) != i || !(innovation.sigma > 0.0)) continue;
      const double ratio = innovation.innovation / innovation.sigma;
      low = std::min(low, ratio);
      high = std::max(high, ratio);
      sum += ratio;
      ++count;
    }
    if (count > 0) {
      columns.set(name + ".mean-", low);
      columns.set(name + ".mean", sum / count);
      columns.set(name + ".mean+", high);
    }
    if (model.rows_used == 0) continue;
    const double n = model.rows_used;  // 95 % of consistent scans are between
    columns.set(name + ".nis", model.nis / n);
    columns.set(name + ".one-", chi2_quantile(0.025, n) / n);
    columns.set(name + ".one", 1.0);
    columns.set(name + ".one+", chi2_quantile(0.975, n) / n);
  }
}

void ReportBuilder::add_points(const Odometry& odometry, double seconds) {
  Columns& columns = page_.columns;
  const UpdateReport& report = odometry.report();
  columns.set("n.received", report.detections);
  columns.set("n.kept", report.detections_kept);
  columns.set("n.static", report.static_detections);
  if (report.detections_kept > 0) {
    columns.set("n.share", static_cast<double>(report.static_detections) / report.detections_kept);
  }
  columns.set("n.landmarks", report.landmarks);
  columns.set("n.matched", report.landmarks_matched);
  columns.set("n.clones", report.clones);
  columns.set("n.ms", 1e3 * to_seconds(report.update_time));
  columns.set("n.quality", report.health.quality);
  page_.marks.start_scan(seconds, odometry.at_scan().p_WB);
  for (const PointReport& point : odometry.points()) {
    page_.marks.add(point.point_W, point.residual, static_cast<std::uint8_t>(point.label));
    ++rates_[static_cast<int>(std::lround(point.range_rate / rate_bin()))];
  }
  for (const LandmarkReport& landmark : odometry.landmarks()) {
    const double sigma = std::sqrt(std::max(0.0, landmark.covariance_W.diagonal().maxCoeff()));
    page_.marks.add(landmark.position_W, sigma, Marks::kLandmark);
  }
}

void ReportBuilder::add_truth(const Odometry& odometry, double seconds) {
  const eval::Trajectory& truth = start_.truth;
  const NavState& x = odometry.at_scan();
  const Time time = x.time;
  while (next_truth_ < truth.size() && truth[next_truth_].time < time) ++next_truth_;
  if (next_truth_ >= truth.size() || truth[next_truth_ - 1].time > time) return;
  const eval::StampedPose& before = truth[next_truth_ - 1];
  const eval::StampedPose& after = truth[next_truth_];
  if (after.time - before.time > std::chrono::seconds(1)) return;  // a gap of the truth
  eval::StampedPose there = eval::interpolate(before, after, time);
  const eval::StampedPose here{time, x.p_WB, x.q_WB};
  const bool first = !over_;
  if (first) over_ = start_.lay_truth_over ? laid_over(there, here) : Pose{};
  there = eval::transformed(*over_, there);
  if (first) last_truth_ = there.p;
  truth_length_ += (there.p - last_truth_).norm();
  last_truth_ = there.p;
  page_.paths[1].add(seconds, there.p);
  const Vector3d error = here.p - there.p;
  if (time != error_time_) {  // of several updates at one instant the last one counts
    ++instants_;
    squares_ += last_error_ * last_error_;
    error_time_ = time;
  }
  last_error_ = error.norm();
  set_vector(&page_.columns, "e", error, sigma_of(odometry.covariance(), body::kPosition));
  page_.columns.set("e.yaw", eval::yaw_error({there, here}));
  page_.columns.set("se.yaw", yaw_sigma_);
  page_.columns.set("e.tilt", eval::tilt_error({there, here}));
}

double ReportBuilder::rate_bin() const {
  const double grid = start_.options.radar.doppler_resolution;
  return grid > 0.0 ? grid : kRateBin;
}

void ReportBuilder::finish_histogram() {
  if (rates_.empty()) return;
  const int first = rates_.begin()->first;
  const int last = rates_.rbegin()->first;
  const int merged = 1 + (last - first) / 160;
  Histogram h{"Points by range rate",
              "number of them; those of static points are unfolded",
              "m/s",
              (first - 0.5) * rate_bin(),
              merged * rate_bin(),
              {}};
  h.counts.resize(1 + static_cast<std::size_t>((last - first) / merged));
  for (const auto& [bin, count] : rates_) {
    h.counts[static_cast<std::size_t>((bin - first) / merged)] += count;
  }
  const double fold = start_.options.radar.max_doppler;
  if (fold > 0.0) {
    h.lines = {-fold, fold};
    h.note += fmt::format("; lines at the ambiguity, ±{:.2f} m/s", fold);
  }
  page_.histograms.push_back(std::move(h));
}

void ReportBuilder::close() {
  finish_histogram();
  std::erase_if(page_.paths, [](const Path& path) { return path.times.empty(); });
  if (instants_ == 0) return;
  const double sum = squares_ + last_error_ * last_error_;
  const double percent = 100.0 * last_error_ / truth_length_;
  std::string end = fmt::format("{:.3f} m", last_error_);
  if (truth_length_ > 0.0) end += fmt::format(", {:.2f} % of {:.1f} m", percent, truth_length_);
  if (last_time_ - error_time_ > kTruthEnds) {
    end +=
        fmt::format(", at {:.1f} s: there the truth ends", to_seconds(error_time_ - page_.begin));
  }
  page_.card.push_back({"Error at the end", end});
  page_.card.push_back(
      {"Position error (RMSE)",
       fmt::format("{:.3f} m{}", std::sqrt(sum / static_cast<double>(instants_)),
                   start_.lay_truth_over ? ", truth laid over the first pose" : "")});
}

}  // namespace rio::view
