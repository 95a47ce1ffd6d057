// SPDX-License-Identifier: BSD-3-Clause
// Faults of the configuration: mounting, and starts in flight.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "experiment/fault.hpp"
#include "rio/core/so3.hpp"

namespace rio::experiment {

namespace {

constexpr double kDegree = M_PI / 180.0;

Fault turned_mounting(double degrees, Promise promise) {
  return {.name = fmt::format("mounting wrong by {} deg", degrees),
          .promise = promise,
          .duration = kForGood,
          .configure = [degrees](Options& o) {
            const Vector3d axis = Vector3d(1.0, 1.0, 1.0).normalized();
            Quaternion& rotation = o.radar.T_BS.rotation;
            rotation = (rotation * quaternion_exp(degrees * kDegree * axis)).normalized();
          }};
}

/// A start in flight from the truth with the sigmas of the options' start, modified.
Fault start(const std::string& name, Promise promise, double within,
            const std::function<void(io::StartFile&)>& change) {
  return {.name = "start in flight, " + name,
          .promise = promise,
          .within = within,
          .duration = promise == Promise::kIgnored ? 1.0 : kForGood,
          .change = [change](Event& e, Moment& m) {
            if (!e.is_imu() || m.n != 0) return;
            auto start = std::make_shared<io::StartFile>();
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
Fault off(const char* what, int component, double size, bool honest, Promise promise,
          double within) {
  return start(fmt::format("{}, sigma {}", what, honest ? "honest" : "lying"), promise, within,
               [component, size, honest](io::StartFile& s) {
                 Eigen::Matrix<double, body::kSize, 1> error = {};
                 error.setZero();
                 error[component] = size;
                 s.state.q_WB = s.state.q_WB * quaternion_exp(error.segment<3>(body::kAttitude));
                 s.state.p_WB += error.segment<3>(body::kPosition);
                 s.state.v_WB += error.segment<3>(body::kVelocity);
                 s.state.gyro_bias += error.segment<3>(body::kGyroBias);
                 s.state.accel_bias += error.segment<3>(body::kAccelBias);
                 if (honest) s.covariance(component, component) = size * size;
               });
}

std::vector<Fault> wrong_starts() {
  constexpr Promise kRecovered = Promise::kRecovered;
  constexpr Promise kHonest = Promise::kHonest;
  constexpr int kRoll = body::kAttitude;
  constexpr int kYaw = body::kAttitude + 2;
  return {
      off("1 m off", body::kPosition, 1.0, true, kHonest, 0.0),
      off("20 deg of yaw off", kYaw, 20.0 * kDegree, true, kRecovered, 10.0),
      off("5 deg of roll off", kRoll, 5.0 * kDegree, true, kRecovered, 10.0),
      off("5 deg of roll off", kRoll, 5.0 * kDegree, false, kRecovered, 15.0),
      off("20 deg of roll off", kRoll, 20.0 * kDegree, true, kRecovered, 10.0),
      off("20 deg of roll off", kRoll, 20.0 * kDegree, false, kRecovered, 15.0),
      off("90 deg of roll off", kRoll, 90.0 * kDegree, true, kRecovered, 20.0),
      off("90 deg of roll off", kRoll, 90.0 * kDegree, false, kRecovered, 20.0),
      off("1 m/s off", body::kVelocity, 1.0, true, kRecovered, 5.0),
      off("1 m/s off", body::kVelocity, 1.0, false, kRecovered, 15.0),
      off("5 m/s off", body::kVelocity, 5.0, true, kRecovered, 5.0),
      off("5 m/s off", body::kVelocity, 5.0, false, kRecovered, 15.0),
      off("gyro bias 0.05 rad/s off", body::kGyroBias, 0.05, true, kRecovered, 10.0),
      off("gyro bias 0.05 rad/s off", body::kGyroBias, 0.05, false, kRecovered, 15.0),
      off("accel bias 0.5 m/s^2 off", body::kAccelBias, 0.5, true, kRecovered, 10.0),
      off("accel bias 0.5 m/s^2 off", body::kAccelBias, 0.5, false, kRecovered, 15.0),
  };
}

std::vector<Fault> impossible_starts() {
  constexpr Promise kIgnored = Promise::kIgnored;
  return {
      start("velocity NaN", kIgnored, 0.0, [](io::StartFile& s) { s.state.v_WB.x() = NAN; }),
      start("quaternion zero", kIgnored, 0.0,
            [](io::StartFile& s) { s.state.q_WB.coeffs().setZero(); }),
      start("quaternion of 1e200", kIgnored, 0.0,
            [](io::StartFile& s) { s.state.q_WB.coeffs() *= 1e200; }),
      start("time 0", kIgnored, 0.0, [](io::StartFile& s) { s.state.time = Time{0}; }),
      start("covariance NaN", kIgnored, 0.0, [](io::StartFile& s) { s.covariance(3, 3) = NAN; }),
      start("covariance indefinite", kIgnored, 0.0,
            [](io::StartFile& s) { s.covariance(3, 3) = -1.0; }),
  };
}

}  // namespace

std::vector<Fault> configuration_faults() {
  std::vector<Fault> all = {
      turned_mounting(5.0, Promise::kHonest),
      turned_mounting(20.0, Promise::kReported),
      turned_mounting(90.0, Promise::kReported),
      turned_mounting(180.0, Promise::kReported),
      {.name = "mounting wrong by 0.3 m",
       .promise = Promise::kHonest,
       .duration = kForGood,
       .configure = [](Options& o) { o.radar.T_BS.translation.x() += 0.3; }},
  };
  for (Fault& fault : wrong_starts()) all.push_back(std::move(fault));
  for (Fault& fault : impossible_starts()) all.push_back(std::move(fault));
  return all;
}

}  // namespace rio::experiment
