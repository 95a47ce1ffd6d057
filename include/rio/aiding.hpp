// SPDX-License-Identifier: BSD-3-Clause
// Measurements of sensors other than the radar: barometer, range to the ground, velocity, position
// or heading; or your own model, of another sensor or of points of the radar. C++17.
//
//   options.auxiliary.declare<HeightBias>();                    // what the model estimates beside
//   auto odometry = rio::Odometry::create(options);
//   odometry->add_measurement({time, Barometer{}, {height, sigma}});
//   rio::auxiliary<HeightBias>(*odometry)->value;
//
// The model concept is in models/aiding_measurement.hpp; included models are in models/aids.hpp.
#pragma once

#include <optional>

#include "rio/models/aiding_measurement.hpp"
#include "rio/rio.hpp"

namespace rio {

/// Estimate of an auxiliary state.
template <class Block>
struct AuxiliaryEstimate {
  typename Block::Value value;
  Eigen::Matrix<double, Block::kDof, Block::kDof> covariance;
};

/// At the last scan; empty if the state was not declared.
template <class Block>
std::optional<AuxiliaryEstimate<Block>> auxiliary(const Odometry& odometry) {
  AuxiliaryEstimate<Block> out;
  if (!odometry.auxiliary(Block::kName, out.value.data(), out.covariance.data())) return {};
  return out;
}

}  // namespace rio
