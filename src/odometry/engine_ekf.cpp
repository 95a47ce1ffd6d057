// SPDX-License-Identifier: BSD-3-Clause
#include "engine.hpp"
#include "rio/ekf/ekf.hpp"

namespace rio {

std::unique_ptr<Odometry::Impl> make_ekf_engine(const Options& options) {
  return std::make_unique<Engine<Ekf>>(options);
}

}  // namespace rio
