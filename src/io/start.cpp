// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/start.hpp"

#include <charconv>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <system_error>

#include "decimal.hpp"
#include "yaml.hpp"

namespace rio::io {

namespace {

using Handlers = std::map<std::string, std::function<void(const YAML::Node&)>>;

/// Calls the handler of the key of each entry of `map`; returns the keys.
std::set<std::string> dispatch(const YamlFile& file, const YAML::Node& map,
                               const Handlers& handlers) {
  std::vector<std::string> known;
  for (const auto& handler : handlers) known.push_back(handler.first);
  std::set<std::string> seen;
  for (const auto& entry : map) {
    const std::string& key = entry.first.Scalar();
    const auto handler = handlers.find(key);
    if (handler == handlers.end()) {
      fail_at(file, entry.first, "unknown key \"" + key + "\"" + did_you_mean(key, known));
    }
    handler->second(entry.second);
    seen.insert(key);
  }
  return seen;
}

Vector3d finite_vector(const YamlFile& file, const YAML::Node& node, const std::string& key,
                       const char* unit) {
  const std::vector<double> v = yaml_numbers(file, node, key, unit, 3);
  Vector3d vector(v[0], v[1], v[2]);
  if (!vector.allFinite()) fail_at(file, node, key + ": not finite");
  return vector;
}

/// One sigma for all axes, or one per axis, squared.
Vector3d variances(const YamlFile& file, const YAML::Node& node, const std::string& key,
                   const char* unit) {
  const Vector3d sigma = node.IsScalar()
                             ? Vector3d(Vector3d::Constant(yaml_number(file, node, key, unit)))
                             : finite_vector(file, node, key, unit);
  if (!sigma.allFinite() || sigma.minCoeff() < 0.0) fail_at(file, node, key + ": below zero");
  return sigma.cwiseAbs2();
}

}  // namespace

BodyCovariance start_covariance(const Quaternion& q_WB, const StartOptions& start) {
  const Matrix3d R_WB = q_WB.toRotationMatrix();
  const double tilt_var = start.sigma_tilt * start.sigma_tilt;
  const Vector3d attitude_W(tilt_var, tilt_var, start.sigma_yaw * start.sigma_yaw);
  const auto isotropic = [](double sigma) {
    return Matrix3d(Matrix3d::Identity() * sigma * sigma);
  };
  BodyCovariance P = BodyCovariance::Zero();
  P.block<3, 3>(body::kAttitude, body::kAttitude) =
      R_WB.transpose() * attitude_W.asDiagonal() * R_WB;
  P.block<3, 3>(body::kPosition, body::kPosition) = isotropic(start.sigma_position);
  P.block<3, 3>(body::kVelocity, body::kVelocity) = isotropic(start.sigma_velocity);
  P.block<3, 3>(body::kGyroBias, body::kGyroBias) = isotropic(start.sigma_gyro_bias);
  P.block<3, 3>(body::kAccelBias, body::kAccelBias) = isotropic(start.sigma_accel_bias);
  return P;
}

Alignment load_start(const std::filesystem::path& path, const StartOptions& start,
                     Time default_time) {
  const YamlFile file = load_yaml(path);
  Alignment out;
  out.state.time = default_time;
  std::map<int, Vector3d> given;  // first row of the block -> variances

  const struct {
    const char* key;
    const char* unit;
    int row;
    Vector3d* value;  ///< null: given otherwise
  } blocks[] = {{"position", "m", body::kPosition, &out.state.p_WB},
                {"orientation", "rad", body::kAttitude, nullptr},
                {"velocity", "m/s", body::kVelocity, &out.state.v_WB},
                {"gyro_bias", "rad/s", body::kGyroBias, &out.state.gyro_bias},
                {"accel_bias", "m/s^2", body::kAccelBias, &out.state.accel_bias}};
  Handlers sigmas;
  Handlers keys = {
      {"quaternion_wxyz",
       [&](const YAML::Node& node) {
         const std::vector<double> v = yaml_numbers(file, node, "quaternion_wxyz", "", 4);
         const auto q = unit_quaternion(v[0], v[1], v[2], v[3]);
         if (!q) fail_at(file, node, "quaternion_wxyz: not a unit quaternion");
         out.state.q_WB = *q;
       }},
      {"time_ns",
       [&](const YAML::Node& node) {
         const std::string& text = node.Scalar();
         Time::rep ns = 0;
         const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ns);
         if (error != std::errc{} || end != text.data() + text.size()) {
           fail_at(file, node, "time_ns: not an integer");
         }
         out.state.time = Time(ns);
       }},
      {"sigma",
       [&](const YAML::Node& node) {
         if (!node.IsMap()) fail_at(file, node, "sigma: a map is expected");
         dispatch(file, node, sigmas);
       }},
  };
  for (const auto& block : blocks) {
    sigmas[block.key] = [&](const YAML::Node& node) {
      given[block.row] = variances(file, node, std::string("sigma.") + block.key, block.unit);
    };
    if (block.value == nullptr) continue;
    keys[block.key] = [&](const YAML::Node& node) {
      *block.value = finite_vector(file, node, block.key, block.unit);
    };
  }
  const std::set<std::string> seen = dispatch(file, file.root, keys);
  for (const char* required : {"quaternion_wxyz", "velocity"}) {
    if (seen.count(required) == 0)
      throw std::runtime_error(file.name + ": " + required + " missing");
  }

  out.covariance = start_covariance(out.state.q_WB, start);
  for (const auto& [row, variance] : given) {
    out.covariance.block<3, 3>(row, row) = variance.asDiagonal();
  }
  return out;
}

}  // namespace rio::io
