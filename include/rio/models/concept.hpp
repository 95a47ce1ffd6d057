// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: the concept of a measurement model, shared by all back-ends.
//
// A model is a pure function: it does not gate, weight, look up columns, allocate or log.
//   kModel        its name in the report; for sensors other than the radar (rio/aiding.hpp): kName
//   kDim          rows of one measurement
//   Blocks        BlockList<...> of the state blocks it touches, in Jacobian column order
//   Measurement   what was measured, with its own noise
//   evaluate(z, value of each block ..., r, J, R) -> bool
//     r = z - h(x);  J = dh/dx in the errors of the blocks, may be null;  R = covariance of r at
//     the true state; false = outside the model's domain, outputs undefined. Same r with and
//     without J.
#pragma once

#include <concepts>
#include <tuple>

#include "rio/report.hpp"
#include "rio/state/blocks.hpp"

namespace rio {

template <int kRows>
using ResidualOf = Eigen::Matrix<double, kRows, 1>;
template <int kRows, int kColumns>
using JacobianOf = Eigen::Matrix<double, kRows, kColumns>;

/// Residual, Jacobian and noise of one measurement of model M.
template <class M>
struct Evaluation {
  ResidualOf<M::kDim> r;
  JacobianOf<M::kDim, M::Blocks::kDof> J;
  JacobianOf<M::kDim, M::kDim> R;
};

/// Calls a model with its block values as a tuple.
template <class M>
bool evaluate(const M& model, const typename M::Measurement& z,
              const typename M::Blocks::Values& blocks, Evaluation<M>* out,
              bool with_jacobian = true) noexcept {
  return std::apply(
      [&](const auto&... value) {
        return model.evaluate(z, value..., out->r, with_jacobian ? &out->J : nullptr, out->R);
      },
      blocks);
}

/// The direction to a point nearer to the radar than this is undefined: out of the domain [m].
inline constexpr double kMinRange = 1e-3;

template <class M>
concept MeasurementModel = requires(const M& model, const typename M::Measurement& z,
                                    const typename M::Blocks::Values& blocks, Evaluation<M>* out) {
  requires requires {
    { M::kModel } -> std::convertible_to<Model>;
  } || requires {
    { M::kName } -> std::convertible_to<const char*>;
  };
  { M::kDim } -> std::convertible_to<int>;
  { evaluate(model, z, blocks, out) } -> std::same_as<bool>;
};

}  // namespace rio
