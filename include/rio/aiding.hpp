// SPDX-License-Identifier: BSD-3-Clause
// Measurements of other sensors than the radar: a barometer, a range to the ground, a velocity, a
// position or heading, or any model of your own. C++17.
//
//   options.auxiliary.declare<HeightBias>();                    // what the model estimates beside
//   auto odometry = rio::Odometry::create(options);
//   odometry->add_measurement({time, Barometer{}, {height, sigma}});
//   rio::auxiliary<HeightBias>(*odometry)->value;
//
// What a model is: models/aiding_measurement.hpp. Those at hand: models/aids.hpp.
#pragma once

#include <optional>

#include "rio/models/aiding_measurement.hpp"
#include "rio/rio.hpp"

namespace rio {

/// What is known of an auxiliary state.
template <class Block>
struct AuxiliaryEstimate {
  typename Block::Value value;
  Eigen::Matrix<double, Block::kDof, Block::kDof> covariance;
};

/// At the last scan; nothing if the state was not declared.
template <class Block>
std::optional<AuxiliaryEstimate<Block>> auxiliary(const Odometry& odometry) {
  AuxiliaryEstimate<Block> out;
  if (!odometry.auxiliary(Block::kName, out.value.data(), out.covariance.data())) return {};
  return out;
}

}  // namespace rio
