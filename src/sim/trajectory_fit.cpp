// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/trajectory_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace rio::sim {

namespace {

/// A sample: position in the world of the recording [m] and yaw [rad].
struct Observation {
  double time = 0.0;  ///< after the first sample [s]
  Trajectory::Control value;
};

void check(const std::vector<eval::StampedPose>& poses) {
  constexpr std::size_t kFewest = 10;
  constexpr double kShortest = 2.0;  // [s], ten knots of the default spacing
  const auto fail = [](const std::string& why) {
    throw std::runtime_error("recorded path: " + why);
  };
  if (poses.size() < kFewest) {
    fail(std::to_string(poses.size()) + " poses, at least " + std::to_string(kFewest) +
         " are needed");
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string which = "pose " + std::to_string(i + 1);
    if (!poses[i].p.allFinite() || !poses[i].q.coeffs().allFinite()) fail(which + " is not finite");
    // 1e-3: text files round their numbers
    if (std::abs(poses[i].q.norm() - 1.0) > 1e-3) fail(which + " has no unit quaternion");
    if (i > 0 && poses[i].time <= poses[i - 1].time) fail(which + " is not later than the last");
  }
  const double duration = to_seconds(poses.back().time - poses.front().time);
  if (duration < kShortest) {
    fail(std::to_string(duration) + " s long, at least " + std::to_string(kShortest) +
         " s are needed");
  }
}

/// Forward, left and up as columns in the recorded body axes B. Up is the axis of B nearest to the
/// world's up; forward is x if up is +-z (robots), else z (x up: EuRoC's IMU; -y up: a camera; y
/// up: motion capture); left = up x forward. Throws if no axis of B is upright.
Matrix3d forward_left_up(const std::vector<eval::StampedPose>& poses) {
  constexpr double kUpright = 35.0 * std::numbers::pi / 180.0;  // half way between two axes is 45
  Vector3d mean = Vector3d::Zero();
  for (const eval::StampedPose& pose : poses) mean += pose.q.conjugate() * Vector3d::UnitZ();
  Eigen::Index axis = 0;
  if (!(mean.cwiseAbs().maxCoeff(&axis) > std::cos(kUpright) * mean.norm())) {
    throw std::runtime_error("recorded path: no axis of the body is within 35 deg of upright");
  }
  Matrix3d R_BF;
  R_BF.col(2) = (mean[axis] > 0.0 ? 1.0 : -1.0) * Vector3d::Unit(axis);
  R_BF.col(0) = axis == 2 ? Vector3d::UnitX() : Vector3d::UnitZ();
  R_BF.col(1) = R_BF.col(2).cross(R_BF.col(0));
  return R_BF;
}

std::vector<Observation> observe(const std::vector<eval::StampedPose>& poses,
                                 const Matrix3d& R_BF) {
  std::vector<Observation> observations;
  double yaw = 0.0;
  for (const eval::StampedPose& pose : poses) {
    const Vector3d left = pose.q.normalized() * R_BF.col(1);
    // the turn since the last sample is taken the shorter way round
    yaw += std::remainder(std::atan2(-left.x(), left.y()) - yaw, 2.0 * std::numbers::pi);  // (E2)
    observations.push_back(
        {to_seconds(pose.time - poses.front().time), {pose.p.x(), pose.p.y(), pose.p.z(), yaw}});
  }
  return observations;
}

/// Time to accelerate to the speed of [first, last), samples from an end inwards [s].
template <class Iterator>
double lead(Iterator first, Iterator last) {
  constexpr double kShortest = 2.0;      // [s], to reduce turn rate and acceleration
  constexpr double kAcceleration = 2.0;  // [m/s^2], 12 deg of tilt
  constexpr double kWindow = 0.5;        // [s], a millimetre of noise is 2 mm/s
  const auto far = std::find_if(
      first, last, [&](const Observation& o) { return std::abs(o.time - first->time) >= kWindow; });
  const double distance = (far->value - first->value).template head<3>().norm();
  return std::max(kShortest, distance / std::abs(far->time - first->time) / kAcceleration);
}

/// The spline as a linear map from its unknowns: all controls but the equal ones at the ends.
class Spline {
 public:
  static constexpr int kOrder = 6;
  /// `leads`: from the start of the motion to the first sample, and from the last to its end [s].
  Spline(const std::vector<Observation>& observations, std::array<double, 2> leads, double spacing)
      : observations_(observations), before_(leads[0]), spacing_(spacing) {
    const double seconds = leads[0] + observations.back().time + leads[1];
    spans_ = static_cast<int>(std::ceil(seconds / spacing));
  }

  /// (E1); the controls relative to the first sample. Throws if they are not determined.
  std::vector<Trajectory::Control> fit() const {
    std::vector<Eigen::Triplet<double>> triplets;
    Eigen::MatrixX4d right = Eigen::MatrixX4d::Zero(unknowns(), 4);
    for (const Observation& observation : observations_) {
      const auto [span, weights] = basis(observation.time);
      add(span, weights, 1.0, &triplets);
      for (int j = 0; j < kOrder; ++j) {
        right.row(unknown(span + j)) +=
            weights[j] * (observation.value - observations_.front().value).transpose();
      }
    }
    constexpr double kPenalty = 1e-4;  // (E3)
    const double per_knot =
        static_cast<double>(observations_.size()) * spacing_ / observations_.back().time;
    for (int k = 0; k + 3 < controls(); ++k) {
      add(k, Eigen::Vector4d(-1.0, 3.0, -3.0, 1.0), kPenalty * per_knot, &triplets);
    }
    Eigen::SparseMatrix<double> normal(unknowns(), unknowns());
    normal.setFromTriplets(triplets.begin(), triplets.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
    const Eigen::MatrixX4d solution = solver.solve(right);
    if (solver.info() != Eigen::Success || !solution.allFinite()) {
      throw std::runtime_error("recorded path: the samples do not determine a path");
    }
    std::vector<Trajectory::Control> result;
    result.reserve(static_cast<std::size_t>(controls()));
    for (int k = 0; k < controls(); ++k) result.emplace_back(solution.row(unknown(k)));
    return result;
  }

  /// Root mean square of the distances from the samples to the spline of `fitted` [m].
  double rms(const std::vector<Trajectory::Control>& fitted) const {
    double sum = 0.0;
    for (const Observation& observation : observations_) {
      const auto [span, weights] = basis(observation.time);
      Trajectory::Control off = observations_.front().value - observation.value;
      for (int j = 0; j < kOrder; ++j) {
        off += weights[j] * fitted[static_cast<std::size_t>(span) + static_cast<std::size_t>(j)];
      }
      sum += off.head<3>().squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(observations_.size()));
  }

 private:
  static constexpr int kEqual = kOrder - 1;  // controls at each end
  struct Basis {
    int span;
    Eigen::Matrix<double, kOrder, 1> weights;
  };

  int controls() const { return spans_ + kOrder - 1; }
  int unknowns() const { return controls() - 2 * (kEqual - 1); }
  int unknown(int control) const { return std::clamp(control - (kEqual - 1), 0, unknowns() - 1); }

  /// Weights of the controls span .. span + 5 at `time` after the first sample.
  Basis basis(double time) const {
    const double s = (before_ + time) / spacing_;
    const int span = std::min(static_cast<int>(s), spans_ - 1);
    Eigen::Matrix<double, kOrder + 1, 1> cumulative;  // C_0 = 1 ... C_6 = 0
    cumulative[0] = 1.0;
    for (int j = 1; j < kOrder; ++j) {
      cumulative[j] = cumulative_basis(static_cast<std::size_t>(j), s - span, 0);
    }
    cumulative[kOrder] = 0.0;
    return {span, cumulative.head<kOrder>() - cumulative.tail<kOrder>()};
  }

  /// `scale` times the square of the row that has `weights` from the control `first` on.
  void add(int first, const Eigen::VectorXd& weights, double scale,
           std::vector<Eigen::Triplet<double>>* triplets) const {
    for (int a = 0; a < weights.size(); ++a) {
      for (int b = 0; b < weights.size(); ++b) {
        triplets->emplace_back(unknown(first + a), unknown(first + b),
                               scale * weights[a] * weights[b]);
      }
    }
  }

  const std::vector<Observation>& observations_;
  double before_;
  double spacing_;
  int spans_ = 0;
};

/// Throws unless the thrust always points upwards.
void check_thrust(const Trajectory& trajectory, double step) {
  constexpr double kLeast = 0.1;  // of gravity; below, the attitude is determined by noise
  for (double t = 0.0; t < trajectory.duration(); t += step) {
    const double lift = trajectory.at(t).accel_W.z() + trajectory.gravity();
    if (lift > kLeast * trajectory.gravity()) continue;
    throw std::runtime_error("recorded path: " + std::to_string(t) +
                             " s after the start it falls freely or is pulled down, which thrust "
                             "cannot do; a jump in the recording, or too fine a knot spacing?");
  }
}

}  // namespace

TrajectoryFit fit_trajectory(const std::vector<eval::StampedPose>& poses,
                             const PathOptions& options, Time start) {
  check(poses);
  const Matrix3d R_BF = forward_left_up(poses);
  const std::vector<Observation> observations = observe(poses, R_BF);
  const std::array<double, 2> leads = {lead(observations.begin(), observations.end()),
                                       lead(observations.rbegin(), observations.rend())};
  const Spline spline(observations, leads, options.fit_spacing);
  std::vector<Trajectory::Control> controls = spline.fit();

  TrajectoryFit fit;
  fit.q_FB = Quaternion(R_BF.transpose());
  fit.first = options.stand_before + leads[0];
  fit.rms = spline.rms(controls);
  const Trajectory::Control origin = controls.front();
  const Trajectory::Control& zero = observations.front().value;
  fit.T_RW.rotation =
      Quaternion(Eigen::AngleAxisd(zero[3] + origin[3], Vector3d::UnitZ()).toRotationMatrix());
  fit.T_RW.translation = (zero + origin).head<3>();
  for (Trajectory::Control& control : controls) {
    control -= origin;
    control.head<3>() = fit.T_RW.rotation.conjugate() * control.head<3>().eval();
  }
  fit.trajectory = Trajectory(std::move(controls), {.start = start,
                                                    .knot_spacing = options.fit_spacing,
                                                    .stand_before = options.stand_before,
                                                    .stand_after = options.stand_after,
                                                    .level = options.ground});
  check_thrust(fit.trajectory, options.fit_spacing / 8.0);
  return fit;
}

}  // namespace rio::sim
