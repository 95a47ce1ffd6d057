// SPDX-License-Identifier: BSD-3-Clause
// A dense matrix of standard normal numbers.
#pragma once

#include <Eigen/Core>

#include "rio/sim/random.hpp"

namespace rio::test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

inline MatrixXd random_matrix(sim::Random& random, Eigen::Index rows, Eigen::Index cols) {
  MatrixXd m(rows, cols);
  for (Eigen::Index c = 0; c < cols; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) m(r, c) = random.normal();
  }
  return m;
}

}  // namespace rio::test
