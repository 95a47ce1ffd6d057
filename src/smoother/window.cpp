// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/window.hpp"

namespace rio {

void WindowState::clear() {
  scan = kNoScan;
  scanned = {};
  to_next.invalidate();
  measurements.clear();
  aiding.clear();
}

Window::Window(std::size_t capacity, const Options& options) : slots_(capacity) {
  for (WindowState& state : slots_) {
    state.measurements.reserve(options);
    state.aiding.reserve(kMaxAiding);
  }
}

WindowState& Window::push() {
  RIO_ASSERT(size_ < slots_.size());
  ++size_;
  newest().clear();
  return newest();
}

std::size_t Window::first_from(Time time) const {
  std::size_t i = 0;
  while (i < size_ && (*this)[i].nav.time < time) ++i;
  return i;
}

int Window::find(ScanId scan) const {
  for (std::size_t i = 0; i < size_; ++i) {
    if ((*this)[i].scan == scan) return static_cast<int>(i);
  }
  return -1;
}

void Window::publish(Estimate* x) const {
  x->clones.clear();
  for (std::size_t k = 0; k < size_; ++k) {
    const NavState& nav = (*this)[k].nav;
    x->clones.push_back({(*this)[k].scan, {nav.q_WB.toRotationMatrix(), nav.p_WB}, {}});
  }
}

bool Window::measures_landmark(std::size_t i) const {
  for (std::size_t k = 0; k < size_; ++k) {
    if ((*this)[k].measurements.has_landmark(i)) return true;
  }
  return false;
}

}  // namespace rio
