// SPDX-License-Identifier: BSD-3-Clause
// Stage 5: from a model and an estimate to rows: picks each block's value and each block's column.
#pragma once

#include <array>
#include <type_traits>

#include "rio/models/concept.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

/// The estimate with its rotations as matrices: computed once per scan.
struct LinearizationPoint {
  explicit LinearizationPoint(const Estimate& x)
      : estimate(x), T_WB(x.T_WB()), T_BS(x.T_BS), v_WB(x.nav.v_WB), gyro_bias(x.nav.gyro_bias) {}

  const Estimate& estimate;
  RigidPose T_WB;
  RigidPose T_BS;
  Vector3d v_WB;
  Vector3d gyro_bias;
};

/// Which clone and which landmark a measurement refers to, for the models that have one.
struct BlockIndex {
  int clone = 0;
  int landmark = 0;
};

/// Value of one block at x.
template <class Block>
const typename Block::Value& block_value(const LinearizationPoint& x, BlockIndex index) {
  if constexpr (std::is_same_v<Block, BodyPose>) return x.T_WB;
  if constexpr (std::is_same_v<Block, BodyVelocity>) return x.v_WB;
  if constexpr (std::is_same_v<Block, GyroBias>) return x.gyro_bias;
  if constexpr (std::is_same_v<Block, Extrinsics>) return x.T_BS;
  if constexpr (std::is_same_v<Block, ClonePose>) {
    return x.estimate.clones[static_cast<std::size_t>(index.clone)].T_WB;
  }
  if constexpr (std::is_same_v<Block, Landmark>) {
    return x.estimate.landmarks[static_cast<std::size_t>(index.landmark)].p_W;
  }
}

/// Appends model M's rows for z to the open block of `batch`; false if x is outside its domain.
template <MeasurementModel M, class... B>
bool linearize(const M& model, const typename M::Measurement& z, BlockList<B...> blocks,
               const LinearizationPoint& x, BlockIndex index, const Layout& layout,
               RowBatch* batch) {
  Evaluation<M> e;
  if (!model.evaluate(z, block_value<B>(x, index)..., e.r, &e.J, e.R)) return false;
  const auto column = [&]<class Block>(std::type_identity<Block>) {
    return layout.column<Block>(std::is_same_v<Block, Landmark> ? index.landmark : index.clone);
  };
  batch->push(e, blocks, {column(std::type_identity<B>{})...});
  return true;
}

}  // namespace rio
