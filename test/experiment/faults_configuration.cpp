// SPDX-License-Identifier: BSD-3-Clause
// Faults of the configuration: mounting, and starts in flight.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "experiment/fault.hpp"
#include "rio/core/so3.hpp"

namespace rio::experiment {

namespace {

Fault wrong_mounting(const std::string& by, Promised promised,
                     const std::function<void(Pose&)>& change) {
  return {.name = "mounting wrong by " + by,
          .duration = kForGood,
          .promised = promised,
          .configure = [change](Options& o) { change(o.radar.T_BS); }};
}

Fault turned_mounting(double degrees, Promised promised) {
  return wrong_mounting(fmt::format("{} deg", degrees), promised, [degrees](Pose& T_BS) {
    const Vector3d axis = Vector3d(1.0, 1.0, 1.0).normalized();
    T_BS.rotation = (T_BS.rotation * quaternion_exp(degrees * kDegree * axis)).normalized();
  });
}

using Start = Alignment;

/// A start in flight from the truth with the sigmas of the options' start, modified.
Fault start(const std::string& name, Promised promised, const std::function<void(Start&)>& change) {
  const double duration = promised.promise == Promise::kIgnored ? 1.0 : kForGood;
  return {"start in flight, " + name, Of::kImu, duration, promised, [change](Event& e, Moment& m) {
            if (m.n != 0) return;
            auto start = std::make_shared<Start>();
            start->state = m.flight.truth_at(e.measured);
            start->covariance = io::start_covariance(start->state.q_WB, StartOptions{});
            change(*start);
            m.more.push_back({.arrival = e.arrival,
                              .measured = e.measured,
                              .kind = Event::Kind::kReset,
                              .start = start});
          }};
}

/// An error of `size` in one component, with the start's sigma (lying) or its own size (honest).
Fault off(const char* what, int component, double size, bool honest, Promised promised) {
  return start(fmt::format("{} off, sigma {}", what, honest ? "honest" : "lying"), promised,
               [component, size, honest](Start& s) {
                 const Eigen::Matrix<double, body::kSize, 1> error =
                     size * Eigen::Matrix<double, body::kSize, 1>::Unit(component);
                 s.state.q_WB = s.state.q_WB * quaternion_exp(error.segment<3>(body::kAttitude));
                 s.state.p_WB += error.segment<3>(body::kPosition);
                 s.state.v_WB += error.segment<3>(body::kVelocity);
                 s.state.gyro_bias += error.segment<3>(body::kGyroBias);
                 s.state.accel_bias += error.segment<3>(body::kAccelBias);
                 if (honest) s.covariance(component, component) = size * size;
               });
}

/// Errors of a start, first with an honest sigma and then with a lying one.
struct StartError {
  const char* what;
  int component;
  double size;
  double honest_within;  ///< time of recovery [s]
  double lying_within;   ///< same
};
constexpr StartError kStartErrors[] = {
    {"5 deg of roll", body::kAttitude, 5.0 * kDegree, 10.0, 15.0},
    {"20 deg of roll", body::kAttitude, 20.0 * kDegree, 10.0, 15.0},
    {"90 deg of roll", body::kAttitude, 90.0 * kDegree, 20.0, 20.0},
    {"1 m/s", body::kVelocity, 1.0, 5.0, 15.0},
    {"5 m/s", body::kVelocity, 5.0, 5.0, 15.0},
    {"gyro bias 0.05 rad/s", body::kGyroBias, 0.05, 10.0, 15.0},
    {"accel bias 0.5 m/s^2", body::kAccelBias, 0.5, 10.0, 15.0}};

}  // namespace

std::vector<Fault> configuration_faults() {
  std::vector<Fault> all = {
      turned_mounting(5.0, Promise::kHonest),
      turned_mounting(20.0, Promise::kReported),
      turned_mounting(90.0, Promise::kReported),
      turned_mounting(180.0, Promise::kReported),
      wrong_mounting("0.3 m", Promise::kHonest, [](Pose& T_BS) { T_BS.translation.x() += 0.3; }),
      off("1 m", body::kPosition, 1.0, true, Promise::kHonest),
      off("20 deg of yaw", body::kAttitude + 2, 20.0 * kDegree, true, recovered(10.0)),
  };
  for (const StartError& e : kStartErrors) {
    all.push_back(off(e.what, e.component, e.size, true, recovered(e.honest_within)));
    all.push_back(off(e.what, e.component, e.size, false, recovered(e.lying_within)));
  }
  /// Refused.
  const auto impossible = [&all](const char* name, const std::function<void(Start&)>& change) {
    all.push_back(start(name, Promise::kIgnored, change));
  };
  impossible("velocity NaN", [](Start& s) { s.state.v_WB.x() = NAN; });
  impossible("quaternion zero", [](Start& s) { s.state.q_WB.coeffs().setZero(); });
  impossible("quaternion of 1e200", [](Start& s) { s.state.q_WB.coeffs() *= 1e200; });
  impossible("time 0", [](Start& s) { s.state.time = Time{0}; });
  impossible("covariance NaN", [](Start& s) { s.covariance(3, 3) = NAN; });
  impossible("covariance indefinite", [](Start& s) { s.covariance(3, 3) = -1.0; });
  return all;
}

}  // namespace rio::experiment
