// SPDX-License-Identifier: BSD-3-Clause
// Measurements of sensors other than the radar: barometer, range to the ground, velocity, position
// or heading; or your own model, of another sensor or of points of the radar. C++17.
//
//   options.auxiliary.declare<HeightOffset>();                  // what the model estimates beside
//   auto odometry = rio::Odometry::create(options);
//   odometry->add_measurement({time, HeightModel{}, {height, sigma}});
//   rio::auxiliary<HeightOffset>(*odometry)->value;
//
// A state that cannot be guessed well enough to linearise, and which is one of several:
//
//   rio::AuxiliaryState anchor = rio::auxiliary_state<Anchor>(index);  // Anchor::kIndexed
//   anchor.delayed = true;  // its measurements are held back until they determine it; those that
//                           // depend on two such states are left out until one of them is known
//   options.auxiliary.declare(anchor);
//   odometry->add_measurement({time, Range{}, {range, sigma}, 0, index});
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

/// At the last scan; empty before the start, and if the state was not declared with this size, or
/// is delayed and not known yet.
/// @param index among those of the kind, if it is indexed
template <class Block>
std::optional<AuxiliaryEstimate<Block>> auxiliary(const Odometry& odometry, int index = 0) {
  AuxiliaryEstimate<Block> out;
  if (!odometry.auxiliary(Block::kName, out.value.data(), out.covariance.data(), index,
                          Block::kDof)) {
    return {};
  }
  return out;
}

}  // namespace rio
