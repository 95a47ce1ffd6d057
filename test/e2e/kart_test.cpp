// SPDX-License-Identifier: BSD-3-Clause
// Real drives of a go-kart on flat ground: strong vibration, lost samples, six points a scan with a
// coarse Doppler. No option is set; densities and mounting are as the recordings tell them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/io/trajectory.hpp"
#include "rio/rio.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

namespace fs = std::filesystem;

constexpr std::array kDrives = {"driveAround1", "labDriveAround1", "labDriveAround3", "outside4"};

struct Figures {
  bool started = false;
  double horizontal = 0.0;  ///< RMS distance to the reference, in percent of the way
  double height = 0.0;      ///< RMS of the height, same
  double within = 0.0;      ///< share of the scans in which zero height is within three sigmas
};

double yaw(const Quaternion& q) {
  const Vector3d forward = q * Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

/// The reference at `time`, interpolated; none outside of it.
std::optional<eval::StampedPose> at(const eval::Trajectory& reference, Time time) {
  const auto next =
      std::lower_bound(reference.begin(), reference.end(), time,
                       [](const eval::StampedPose& pose, Time t) { return pose.time < t; });
  if (next == reference.end()) return std::nullopt;
  if (next == reference.begin()) {
    return next->time == time ? std::optional(*next) : std::nullopt;
  }
  const eval::StampedPose& a = *(next - 1);
  const double weight = to_seconds(time - a.time) / to_seconds(next->time - a.time);
  return eval::StampedPose{time, a.p + weight * (next->p - a.p), a.q.slerp(weight, next->q)};
}

Figures drive(const fs::path& recording, BackEnd backend) {
  const io::Dataset dataset = io::read_dataset(recording);
  const eval::Trajectory reference = io::read_trajectory(recording / "reference.tum");
  Options options;
  options.backend = backend;
  io::apply_sensor_info(dataset, &options);
  const auto odometry = Odometry::create(options);

  Figures figures;
  std::vector<eval::StampedPose> path;
  std::vector<double> sigma;
  const auto record = [&] {
    const NavState& x = odometry->at_scan();
    if (!path.empty() && x.time <= path.back().time) return;
    path.push_back({x.time, x.p_WB, x.q_WB});
    sigma.push_back(std::sqrt(odometry->covariance()(body::kPosition + 2, body::kPosition + 2)));
  };
  std::size_t next = 0;
  for (const ImuSample& sample : dataset.imu) {
    (void)odometry->add_imu(sample);
    if (!odometry->initialized()) continue;
    while (next < dataset.scans.size() && dataset.scans[next].time <= sample.time) {
      (void)odometry->add_scan(dataset.scans[next++]);
    }
    if (odometry->counters().scans > 0) record();
  }
  figures.started = !path.empty();

  double way = 0.0;
  for (std::size_t i = 1; i < reference.size(); ++i) {
    way += (reference[i].p - reference[i - 1].p).head<2>().norm();
  }
  std::optional<eval::StampedPose> first;
  Matrix3d turn = Matrix3d::Identity();
  Vector3d origin = Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto truth = at(reference, path[i].time);
    if (!truth) continue;
    if (!first) {
      first = truth;
      origin = path[i].p;
      turn = Eigen::AngleAxisd(yaw(truth->q) - yaw(path[i].q), Vector3d::UnitZ());
    }
    const Vector3d moved = turn * (path[i].p - origin);
    const Vector3d error = moved - (truth->p - first->p);
    figures.horizontal += error.head<2>().squaredNorm();
    figures.height += moved.z() * moved.z();
    figures.within += std::abs(moved.z()) < 3.0 * sigma[i] ? 1.0 : 0.0;
    ++count;
  }
  figures.started = count > 0;
  figures.horizontal = 100.0 * std::sqrt(figures.horizontal / count) / way;
  figures.height = 100.0 * std::sqrt(figures.height / count) / way;
  figures.within *= 100.0 / count;
  return figures;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// What must be reached, in percent.
struct Bounds {
  BackEnd backend;
  const char* name;
  double horizontal_median;
  double horizontal_worst;
  double height_median;
  double height_worst;
  double within;  ///< mean
};

class Kart : public testing::TestWithParam<Bounds> {};

TEST_P(Kart, FindsItsWay) {
  const Bounds& bounds = GetParam();
  const char* data = std::getenv("RIO_TEST_DATA");
  const fs::path folder = fs::path(data != nullptr ? data : "") / "kart";
  if (data == nullptr || !fs::exists(folder)) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recordings kart";
  }
  std::vector<double> horizontal;
  std::vector<double> height;
  double within = 0.0;
  for (const char* name : kDrives) {
    for (const char* radar : {"_A", "_B"}) {
      const Figures figures = drive(folder / (std::string(name) + radar), bounds.backend);
      EXPECT_TRUE(figures.started) << name << radar;
      horizontal.push_back(figures.horizontal);
      height.push_back(figures.height);
      within += figures.within / (2.0 * kDrives.size());
    }
  }
  const auto expect_below = [&](const char* what, double value, double bound) {
    measured(std::string(bounds.name) + ": " + what, value, "below " + std::to_string(bound));
    EXPECT_LT(value, bound) << what;
  };
  expect_below("horizontal, median [%]", median(horizontal), bounds.horizontal_median);
  expect_below("horizontal, worst [%]", *std::max_element(horizontal.begin(), horizontal.end()),
               bounds.horizontal_worst);
  expect_below("height, median [%]", median(height), bounds.height_median);
  expect_below("height, worst [%]", *std::max_element(height.begin(), height.end()),
               bounds.height_worst);
  measured(std::string(bounds.name) + ": height zero within 3 sigmas [%]", within, "above 95");
  EXPECT_GT(within, bounds.within);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Kart,
                         testing::Values(Bounds{BackEnd::kEkf, "filter", 2.0, 4.0, 1.6, 4.0, 95.0},
                                         Bounds{BackEnd::kSmoother, "window", 2.0, 4.0, 1.5, 4.0,
                                                95.0}),
                         [](const auto& b) { return std::string(b.param.name); });

}  // namespace
}  // namespace rio::test
