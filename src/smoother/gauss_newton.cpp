// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/gauss_newton.hpp"

namespace rio {

GaussNewton::GaussNewton(const SmootherOptions& options, int max_states, int border)
    : options_(options),
      saved_(static_cast<std::size_t>(max_states)),
      dx_(Eigen::VectorXd::Zero(body::kSize * max_states + border)),
      tail_(Eigen::VectorXd::Zero(body::kSize + border)) {}

double GaussNewton::step(const NormalEquations& system) {
  system.solve(&dx_);
  const auto dx = dx_.head(system.size());
  const double squared = dx.dot(system.g());
  return dx.allFinite() && squared >= 0.0 ? std::sqrt(squared) : kNone;
}

void GaussNewton::apply(const NormalEquations& system, Window* window,
                        StateEstimate* state_estimate) {
  for (std::size_t k = 0; k + 1 < window->size(); ++k) {
    add_error(dx_.segment<body::kSize>(body::kSize * static_cast<Eigen::Index>(k)),
              &(*window)[k].nav);
  }
  const int size = system.tail_size();
  tail_.head(size) = dx_.segment(system.size() - size, size);
  state_estimate->correct(tail_);
  window->newest().nav = state_estimate->estimate().nav;
  window->publish(&state_estimate->estimate());
}

}  // namespace rio
