// SPDX-License-Identifier: BSD-3-Clause
// Windows of simulated flights, solved by the smoother and by Ceres with residuals of their own
// (support/window_cost.hpp): both find the same minimum.
//
// The window is put together from what the smoother shows before a scan (prior, states) and after
// it (solution, what the scan measured); its oldest state has been marginalised by then and is
// not compared. Windows are left out if a landmark left at that scan: its measurements are gone.
#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "rio/sim/random.hpp"
#include "support/scanwise_flight.hpp"
#include "support/window_cost.hpp"

namespace rio::test {
namespace {

/// (E3) of kernel.hpp.
class DcsLoss final : public ceres::LossFunction {
 public:
  explicit DcsLoss(double k) : k_(k) {}
  void Evaluate(double x, double rho[3]) const override {
    rho[0] = x;
    rho[1] = 1.0;
    rho[2] = 0.0;
    if (x <= k_) return;
    const double sum = k_ + x;
    rho[0] = 3.0 * k_ - 4.0 * k_ * k_ / sum;
    rho[1] = 4.0 * k_ * k_ / (sum * sum);
    rho[2] = -2.0 * rho[1] / sum;
  }

 private:
  double k_;
};

ceres::LossFunction* loss(const SmootherOptions& o, int rows, double weight) {
  const double k = o.kernel_size * rows;
  ceres::LossFunction* robust = nullptr;  // none
  if (o.kernel == Kernel::kHuber) robust = new ceres::HuberLoss(std::sqrt(k));
  if (o.kernel == Kernel::kCauchy) robust = new ceres::CauchyLoss(std::sqrt(k));
  if (o.kernel == Kernel::kDcs) robust = new DcsLoss(k);
  return new ceres::ScaledLoss(robust, weight, ceres::TAKE_OWNERSHIP);
}

/// What the smoother shows between two scans.
struct Snapshot {
  explicit Snapshot(const Smoother& s)
      : window(s.window()),
        estimate(s.estimate()),
        A(s.prior().A()),
        g(s.prior().g()),
        leading(static_cast<std::size_t>(s.prior().leading_states())) {}

  Window window;
  Estimate estimate;
  Eigen::MatrixXd A;
  Eigen::VectorXd g;
  std::size_t leading;
};

class Referee {
 public:
  /// @param before the window in front of the scan, which ends with its prior just made
  Referee(const Snapshot& before, const Smoother& after, const Options& options)
      : options_(options),
        before_(before),
        x_(after.estimate()),
        window_(before.window.size() + 1) {
    const std::size_t n = before.window.size();
    for (std::size_t k = 0; k < n; ++k) {
      window_[k] = before.window[k];
      if (k > 0) window_[k].nav = after.window()[k - 1].nav;
    }
    window_[n - 1].to_next = after.window()[n - 2].to_next;
    window_[n] = after.window()[n - 1];
    states_.resize(n + 1);
    landmarks_.resize(before.estimate.landmarks.size());
    add_all();
  }

  /// The cost with all but the oldest state where the smoother left them.
  double cost_of_the_smoother() {
    hold(true);
    const double cost = solve();
    hold(false);
    return cost;
  }
  /// The least cost, from a start nearby.
  double least_cost(sim::Random& random) {
    for (double* block : free_) {
      for (int i = 0; i < problem_.ParameterBlockSize(block); ++i)
        block[i] += 1e-3 * random.normal();
    }
    return solve();
  }
  /// Largest distance of the two minima [rad, m, m/s, rad/s, m/s^2, s].
  double distance() const {
    double largest = std::max(std::abs(offset_[0]), std::abs(elevation_[0]));
    const auto take = [&largest](const auto& block) {
      for (const double value : block) largest = std::max(largest, std::abs(value));
    };
    for (std::size_t k = 1; k < states_.size(); ++k) take(states_[k]);
    for (const auto& landmark : landmarks_) take(landmark);
    take(mount_);
    take(scale_);
    return largest;
  }
  /// Of the newest state, at the solution of the smoother.
  Matrix15d covariance() {
    double* const newest = states_.back().data();
    ceres::Covariance covariance{ceres::Covariance::Options()};
    Eigen::Matrix<double, 15, 15, Eigen::RowMajor> P;
    P.setZero();
    if (covariance.Compute(std::vector<std::pair<const double*, const double*>>{{newest, newest}},
                           &problem_)) {
      covariance.GetCovarianceBlock(newest, newest, P.data());
    }
    return P;
  }
  /// A Doppler beyond three sigmas is taken for an outlier, whose direction is not corrected: the
  /// Jacobian of the smoother is not the derivative of its cost there (models/doppler.hpp).
  bool has_uncorrected_doppler() const { return uncorrected_; }

 private:
  ScanCost base(std::size_t k) const {
    return {window_[k], x_.T_BS, x_.doppler_scale, x_.time_offset};
  }
  /// @param loss owned from now on; null = none
  template <class Cost, class... Blocks>
  void add_block(const Cost& cost, int rows, ceres::LossFunction* loss, Blocks*... blocks) {
    const std::array sizes = {static_cast<int>(blocks->size())...};
    problem_.AddResidualBlock(differentiated(cost, sizes, rows), loss,
                              std::vector<double*>{blocks->data()...});
  }
  template <class Cost, class... Blocks>
  void add(const Cost& cost, int rows, double weight, Blocks*... blocks) {
    add_block(cost, rows, loss(options_.smoother, rows, weight), blocks...);
  }

  void add_all() {
    add_prior();
    for (std::size_t k = 0; k < window_.size(); ++k) {
      if (k + 1 < window_.size()) {
        add_block(ImuCost(window_[k].to_next.imu(), options_.imu.gravity, window_[k].nav,
                          window_[k + 1].nav),
                  15, nullptr, &states_[k], &states_[k + 1]);
      }
      add_scan(k);
    }
    for (auto& state : states_) free_.push_back(state.data());
    for (auto& landmark : landmarks_) free_.push_back(landmark.data());
    const auto fix = [this](auto& block, bool estimated) {
      if (estimated) free_.push_back(block.data());
      if (!estimated) problem_.SetParameterBlockConstant(block.data());
    };
    fix(mount_, layout_.has_extrinsics());
    fix(scale_, layout_.has_doppler_scale());
    fix(offset_, layout_.has_time_offset());
    fix(elevation_, layout_.has_elevation_error());
  }

  void add_scan(std::size_t k) {
    const WindowState& s = window_[k];
    auto& state = states_[k];
    const ScanMeasurements& seen = s.measurements;
    for (const auto& m : seen.of<DopplerModel>()) add_doppler(k, m);
    for (const auto& m : seen.of<LandmarkPointModel>()) {
      if (m.landmark >= landmarks_.size()) continue;  // born by this scan, after the solution
      const Vector3d& l = x_.landmarks[m.landmark].p_W;
      add(PointCost{base(k), m.z, m.doppler, l, x_.elevation_error}, m.doppler ? 4 : 3, m.weight,
          &state, &mount_, &scale_, &offset_, &elevation_, &landmarks_[m.landmark]);
    }
    for (const auto& m : seen.of<LandmarkDistanceModel>()) {
      add(RangeCost{base(k), m.z.range, options_.update.sigma_landmark_distance,
                    x_.landmarks[m.landmark].p_W},
          1, m.weight, &state, &mount_, &scale_, &offset_, &landmarks_[m.landmark]);
    }
    for (const auto& m : seen.of<TrailDistanceModel>()) {
      const auto past = std::find_if(window_.begin(), window_.end(),
                                     [&m](const WindowState& w) { return w.scan == m.past; });
      if (past == window_.end()) continue;
      add(TrailCost{base(k), past->nav, m.z, options_.update.sigma_trail_distance}, 1, 1.0, &state,
          &states_[static_cast<std::size_t>(past - window_.begin())], &mount_, &scale_, &offset_);
    }
    for (const auto& m : seen.of<RestModel>()) add(RestCost{s.nav, m.z}, 6, 1.0, &state);
  }

  void add_doppler(std::size_t k, const Measured<DopplerModel>& m) {
    DopplerCost cost{base(k), m.z, options_.update.doppler_directions != DopplerDirections::kExact,
                     std::nullopt};
    const bool corrected = options_.update.doppler_directions >= DopplerDirections::kCorrected;
    if (corrected) cost.length = 1.0 + 0.5 * m.z.direction_cov.trace();
    const auto radar =
        cost.base.radar(states_[k].data(), mount_.data(), scale_.data(), offset_.data());
    double r = 0.0;
    cost(states_[k].data(), mount_.data(), scale_.data(), offset_.data(), &r);
    r *= std::sqrt(m.z.variance_factor);
    uncorrected_ = uncorrected_ || (corrected && std::abs(r) > 2.999);
    // without the correction the Jacobian leaves the change of the variance out
    if (!corrected) cost.frozen_variance = cost.variance(radar.scale * radar.v_S);
    add(cost, 1, m.weight, &states_[k], &mount_, &scale_, &offset_);
  }

  /// What the prior knows of these states and this estimate.
  template <class States>
  PriorCost::Point known_of(const States& states, const Estimate& x, std::size_t landmarks) const {
    PriorCost::Point out{{}, x.of_radar(0), {}};
    for (std::size_t s = 0; s < before_.leading; ++s) out.states.push_back(states[s].nav);
    for (std::size_t i = 0; i < landmarks; ++i) out.landmarks.push_back(x.landmarks[i].p_W);
    return out;
  }

  void add_prior() {
    const int calibration = layout_.size(0) - body::kSize;
    const auto known = static_cast<std::size_t>(
        (before_.A.rows() - body::kSize * static_cast<int>(before_.leading) - calibration) / 3);
    std::vector<double*> blocks;
    std::vector<int> sizes;
    const auto add_block = [&](auto& block) {
      blocks.push_back(block.data());
      sizes.push_back(static_cast<int>(block.size()));
    };
    for (std::size_t s = 0; s < before_.leading; ++s) add_block(states_[s]);
    add_block(mount_);
    add_block(scale_);
    add_block(offset_);
    add_block(elevation_);
    for (std::size_t i = 0; i < known; ++i) add_block(landmarks_[i]);
    PriorCost cost{layout_,
                   known_of(before_.window, before_.estimate, known),
                   known_of(window_, x_, known),
                   {},
                   {}};
    cost.factorise(before_.A, before_.g);
    problem_.AddResidualBlock(differentiated(cost, sizes), nullptr, blocks);
  }

  /// All that is estimated but the oldest state, or none.
  void hold(bool held) {
    for (double* block : free_) {
      if (block == states_[0].data()) continue;
      if (held) problem_.SetParameterBlockConstant(block);
      if (!held) problem_.SetParameterBlockVariable(block);
    }
  }

  double solve() {
    ceres::Solver::Options o;
    o.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    o.max_num_iterations = 300;
    o.function_tolerance = 0.0;  // as far as rounding lets it
    o.gradient_tolerance = 0.0;
    o.parameter_tolerance = 1e-13;
    o.max_num_consecutive_invalid_steps = 20;
    o.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(o, &problem_, &summary);
    return summary.final_cost;
  }

  Options options_;
  Layout layout_{options_.calibration, 0, 0};
  Snapshot before_;
  Estimate x_;
  std::vector<WindowState> window_;  ///< oldest to newest, navs: the reference
  std::vector<std::array<double, 15>> states_;
  std::vector<std::array<double, 3>> landmarks_;
  std::array<double, 6> mount_{};
  std::array<double, 1> scale_{};
  std::array<double, 1> offset_{};
  std::array<double, 1> elevation_{};
  std::vector<double*> free_;  ///< blocks that are estimated
  bool uncorrected_ = false;
  ceres::Problem problem_;
};

struct Case {
  std::string name;
  Kernel kernel = Kernel::kNone;
  bool correction = true;
  CalibrationOptions calibration;
  bool distances = false;  ///< trails and landmarks by distance
};

class CeresReferee : public testing::TestWithParam<Case> {};

TEST_P(CeresReferee, FindsTheSameMinimum) {
  constexpr std::size_t kWindows = 10;
  constexpr std::size_t kEvery = 9;  // scans between two windows, at least
  SmootherFlight flight({.seed = 21, .path = {.length = 20.0, .stand_before = 1.5}});
  Options o = flight.options();
  o.imu.measure_noise = false;  // the noise of a gyro sample is in scan_information_test.cpp
  o.smoother = {
      .window = 6, .max_iterations = 1000, .tolerance = 1e-10, .kernel = GetParam().kernel};
  o.smoother.kernel_size = 1.0;   // small: many residuals are beyond it
  o.smoother.factor_reuse = 0.0;  // the covariance is of the solution
  // what kReliable leaves out of the score is of no cost
  o.update.doppler_directions =
      GetParam().correction ? DopplerDirections::kCorrected : DopplerDirections::kExact;
  o.calibration = GetParam().calibration;
  if (GetParam().distances) {
    o.update.use_trails = true;
    o.update.landmark_measurement = LandmarkMeasurement::kDistance;
  }
  flight.begin(o);
  sim::Random random(22, 1);
  std::size_t windows = 0;
  std::size_t due = 20;  // the window is full, and at rest
  while (windows < kWindows && !flight.over()) {
    const Snapshot before(flight.back_end());
    ASSERT_EQ(flight.step(), Status::kOk);
    if (flight.next() < due || flight.report().landmarks_removed > 0) continue;
    Referee referee(before, flight.back_end(), o);
    if (referee.has_uncorrected_doppler()) continue;
    const double ours = referee.cost_of_the_smoother();
    if (o.smoother.kernel == Kernel::kNone) {
      const Eigen::MatrixXd P = flight.state_estimate().covariance().body();
      EXPECT_LE((P - referee.covariance()).cwiseAbs().maxCoeff(), 1e-6 * P.cwiseAbs().maxCoeff());
    }
    const double least = referee.least_cost(random);
    EXPECT_NEAR(ours, least, 1e-9 * least) << "scan " << flight.next();
    EXPECT_LT(referee.distance(), 1e-6) << "scan " << flight.next();
    due = flight.next() + kEvery;
    ++windows;
  }
  EXPECT_EQ(windows, kWindows);
}

constexpr CalibrationOptions kFixed = {0.0, 0.0, 0.0, 0.0, 0.0};
constexpr CalibrationOptions kMount = {0.05, 0.03, 0.0, 0.0, 0.0};
constexpr CalibrationOptions kRadar = {0.05, 0.03, 0.0, 0.02, 0.03};
constexpr CalibrationOptions kAll = {0.05, 0.03, 0.03, 0.02, 0.03};

INSTANTIATE_TEST_SUITE_P(Windows, CeresReferee,
                         testing::Values(Case{"None", Kernel::kNone, true, kMount},
                                         Case{"NoneUncorrected", Kernel::kNone, false, kMount},
                                         Case{"NoneFixed", Kernel::kNone, true, kFixed},
                                         Case{"NoneRadar", Kernel::kNone, true, kRadar},
                                         Case{"NoneAll", Kernel::kNone, true, kAll},
                                         Case{"NoneAllUncorrected", Kernel::kNone, false, kAll},
                                         Case{"Huber", Kernel::kHuber, true, kMount},
                                         Case{"HuberUncorrected", Kernel::kHuber, false, kMount},
                                         Case{"Cauchy", Kernel::kCauchy, true, kMount},
                                         Case{"CauchyUncorrected", Kernel::kCauchy, false, kMount},
                                         Case{"DcsUncorrected", Kernel::kDcs, false, kMount},
                                         Case{"Dcs", Kernel::kDcs, true, kMount},
                                         Case{"Distances", Kernel::kNone, false, kMount, true}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace rio::test
