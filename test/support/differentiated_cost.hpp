// SPDX-License-Identifier: BSD-3-Clause
// The one type of automatic derivative that all costs of window_cost.hpp share.
#pragma once

#include <utility>

#include "support/window_cost.hpp"

namespace rio::test {

constexpr int kDerivatives = 32;  // taken at once: those of any cost but a trail's and the prior's

/// A cost with its blocks in an array.
template <class Cost, std::size_t kBlocks>
struct Unpacked {
  Cost cost;

  template <class T>
  bool operator()(T const* const* blocks, T* r) const {
    return call(blocks, r, std::make_index_sequence<kBlocks>{});
  }
  template <class T, std::size_t... kIndex>
  bool call(T const* const* blocks, T* r, std::index_sequence<kIndex...>) const {
    return cost(blocks[kIndex]..., r);
  }
};

template <class Cost, std::size_t kBlocks>
ceres::CostFunction* differentiated(const Cost& cost, const std::array<int, kBlocks>& sizes,
                                    int rows) {
  using Packed = Unpacked<Cost, kBlocks>;
  auto* const function =
      new ceres::DynamicAutoDiffCostFunction<Packed, kDerivatives>(new Packed{cost});
  for (const int size : sizes) function->AddParameterBlock(size);
  function->SetNumResiduals(rows);
  return function;
}

}  // namespace rio::test
