// SPDX-License-Identifier: BSD-3-Clause
#include "engine.hpp"
#include "rio/smoother/smoother.hpp"

namespace rio {

std::unique_ptr<Odometry::Impl> make_smoother_engine(const Options& options) {
  return std::make_unique<Engine<Smoother>>(options);
}

}  // namespace rio
