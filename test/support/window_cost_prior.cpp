// SPDX-License-Identifier: BSD-3-Clause
// The prior of marginalisation.
#include "support/differentiated_cost.hpp"
#include "support/window_cost.hpp"

namespace rio::test {

ceres::CostFunction* differentiated(PriorCost&& cost, const std::vector<int>& sizes) {
  const auto rows = static_cast<int>(cost.root.rows());
  auto* const function = new ceres::DynamicAutoDiffCostFunction<PriorCost, kDerivatives>(
      new PriorCost(std::move(cost)));
  for (const int size : sizes) function->AddParameterBlock(size);
  function->SetNumResiduals(rows);
  return function;
}

}  // namespace rio::test
