// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/symmetric.hpp"

#include <Eigen/Cholesky>

namespace rio {

bool factorise_in_place(Eigen::Ref<Eigen::MatrixXd> A) {
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(A).info() == Eigen::Success;
}

}  // namespace rio
