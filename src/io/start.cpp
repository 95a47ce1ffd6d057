// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/start.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "decimal.hpp"
#include "yaml.hpp"

namespace rio::io {

namespace {

/// A part of the state that is three numbers, and of its covariance.
struct Block {
  std::string key;
  const char* unit;
  int row;                    ///< of the covariance
  Vector3d NavState::*value;  ///< null: given otherwise
};
const Block kBlocks[] = {{"position", "m", body::kPosition, &NavState::p_WB},
                         {"orientation", "rad", body::kAttitude, nullptr},
                         {"velocity", "m/s", body::kVelocity, &NavState::v_WB},
                         {"gyro_bias", "rad/s", body::kGyroBias, &NavState::gyro_bias},
                         {"accel_bias", "m/s^2", body::kAccelBias, &NavState::accel_bias}};
const std::vector<std::string> kKeys = {"accel_bias", "gyro_bias", "position", "quaternion_wxyz",
                                        "sigma",      "time_ns",   "velocity"};
const std::vector<std::string> kSigmas = {"accel_bias", "gyro_bias", "orientation", "position",
                                          "velocity"};

/// The block of a key, which is one of `known`.
const Block& block_of(const YamlFile& file, const YAML::Node& key,
                      const std::vector<std::string>& known) {
  const std::string& name = key.Scalar();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    fail_at(file, key, "unknown key \"" + name + "\"" + did_you_mean(name, known));
  }
  return *std::find_if(std::begin(kBlocks), std::end(kBlocks),
                       [&name](const Block& block) { return block.key == name; });
}

Vector3d finite_vector(const YamlFile& file, const YAML::Node& node, const std::string& key,
                       const char* unit) {
  Vector3d vector = yaml_vector(file, node, key, unit);
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
  std::vector<std::pair<int, Vector3d>> given;  // first row of the block, variances
  for (const auto& entry : file.root) {
    const std::string& key = entry.first.Scalar();
    const YAML::Node& node = entry.second;
    if (key == "quaternion_wxyz") {
      out.state.q_WB = yaml_quaternion(file, node, key);
    } else if (key == "time_ns") {
      const auto ns = plain_number_of<Time::rep>(node.Scalar());
      if (!ns) fail_at(file, node, "time_ns: not an integer");
      out.state.time = Time(*ns);
    } else if (key == "sigma") {
      if (!node.IsMap()) fail_at(file, node, "sigma: a map is expected");
      for (const auto& sigma : node) {
        const Block& block = block_of(file, sigma.first, kSigmas);
        given.emplace_back(block.row,
                           variances(file, sigma.second, "sigma." + block.key, block.unit));
      }
    } else {
      const Block& block = block_of(file, entry.first, kKeys);
      out.state.*block.value = finite_vector(file, node, key, block.unit);
    }
  }
  for (const char* required : {"quaternion_wxyz", "velocity"}) {
    if (file.root[required].IsDefined()) continue;
    throw std::runtime_error(file.name + ": " + required + " missing");
  }

  out.covariance = start_covariance(out.state.q_WB, start);
  for (const auto& [row, variance] : given) {
    out.covariance.block<3, 3>(row, row) = variance.asDiagonal();
  }
  return out;
}

}  // namespace rio::io
