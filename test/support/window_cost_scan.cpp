// SPDX-License-Identifier: BSD-3-Clause
// What a scan measured.
#include "support/differentiated_cost.hpp"
#include "support/window_cost.hpp"

namespace rio::test {

template ceres::CostFunction* differentiated(const DopplerCost&, const std::array<int, 4>&, int);
template ceres::CostFunction* differentiated(const PointCost&, const std::array<int, 5>&, int);
template ceres::CostFunction* differentiated(const RangeCost&, const std::array<int, 5>&, int);
template ceres::CostFunction* differentiated(const RestCost&, const std::array<int, 1>&, int);

}  // namespace rio::test
