// SPDX-License-Identifier: BSD-3-Clause
// What ties states to each other: IMU and trails.
#include "support/differentiated_cost.hpp"
#include "support/window_cost.hpp"

namespace rio::test {

template ceres::CostFunction* differentiated(const ImuCost&, const std::array<int, 2>&, int);
template ceres::CostFunction* differentiated(const TrailCost&, const std::array<int, 5>&, int);

}  // namespace rio::test
