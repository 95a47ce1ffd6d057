// SPDX-License-Identifier: BSD-3-Clause
#include "live/outputs.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

namespace rio::live {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json sigmas(const BodyCovariance& P, int block) {
  return numbers(P.diagonal().segment<3>(block).cwiseMax(0.0).cwiseSqrt());
}

std::string json_line(const Odometry& odometry) {
  const NavState& state = odometry.at_scan();
  const UpdateReport& report = odometry.report();
  const BodyCovariance& P = odometry.covariance();
  const Quaternion& q = state.q_WB;
  const Json line = {{"t_ns", state.time.count()},
                     {"p", numbers(state.p_WB)},
                     {"q_wxyz", {q.w(), q.x(), q.y(), q.z()}},
                     {"v", numbers(state.v_WB)},
                     {"sigma_p", sigmas(P, body::kPosition)},
                     {"sigma_phi", sigmas(P, body::kAttitude)},
                     {"sigma_v", sigmas(P, body::kVelocity)},
                     {"health", to_string(report.health.state)},
                     {"quality", report.health.quality},
                     {"reset_counter", report.health.reset_counter},
                     {"radar", report.radar},
                     {"detections", report.detections},
                     {"static", report.static_detections}};
  return line.dump();
}

}  // namespace

EstimateFiles::EstimateFiles(const std::string& tum, const std::string& states,
                             const std::string& json)
    : path_(tum, states), to_stdout_(json == "-") {
  if (!json.empty() && !to_stdout_) json_.emplace(json);
}

void EstimateFiles::on_estimate(const Session& session, Time /*arrival*/) {
  const Odometry& odometry = session.odometry();
  path_.add(odometry.at_scan(), odometry.covariance());
  if (json_) json_->write(json_line(odometry) + "\n");
  if (!to_stdout_) return;
  fmt::print("{}\n", json_line(odometry));
  std::fflush(stdout);  // the reader waits for it
}

void EstimateFiles::on_end() {
  path_.close();
  if (json_) json_->close();
}

}  // namespace rio::live
