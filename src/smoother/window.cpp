// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/window.hpp"

#include <algorithm>

namespace rio {

WindowState::Mark WindowState::mark() const {
  return {dopplers.size(), points.size(), distances.size(), positions.size(),
          trails.size(),   rest,          scanned};
}

void WindowState::cut(const Mark& mark) {
  const auto shorten = [](auto& all, std::size_t size) {
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(size), all.end());
  };
  shorten(dopplers, mark.dopplers);
  shorten(points, mark.points);
  shorten(distances, mark.distances);
  shorten(positions, mark.positions);
  shorten(trails, mark.trails);
  rest = mark.rest;
  scanned = mark.scanned;
}

void WindowState::clear() {
  scan = kNoScan;
  scanned = {};
  to_next.invalidate();
  dopplers.clear();
  points.clear();
  distances.clear();
  positions.clear();
  trails.clear();
  aiding.clear();
  rest.reset();
}

Window::Window(std::size_t capacity, const Options& options) : slots_(capacity) {
  const auto detections = static_cast<std::size_t>(options.frontend.max_detections);
  const auto clones = static_cast<std::size_t>(std::max(1, options.update.max_clones));
  for (WindowState& state : slots_) {
    state.dopplers.reserve(detections);
    state.points.reserve(2 * detections);  // matches and births
    state.distances.reserve(detections);
    state.positions.reserve(detections);
    state.trails.reserve(detections * clones);
    state.aiding.reserve(kMaxAiding);
  }
}

WindowState& Window::push() {
  RIO_ASSERT(size_ < slots_.size());
  ++size_;
  newest().clear();
  return newest();
}

void Window::pop_oldest() {
  first_ = (first_ + 1) % slots_.size();
  --size_;
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
    x->clones.push_back({(*this)[k].scan, {nav.q_WB.toRotationMatrix(), nav.p_WB}});
  }
}

void Window::forget_landmark(std::size_t i, std::size_t last) {
  const auto forget = [i, last](auto& factors) {
    std::erase_if(factors, [i](const auto& f) { return f.landmark == i; });
    for (auto& f : factors) {
      if (f.landmark == last) f.landmark = i;
    }
  };
  for (std::size_t k = 0; k < size_; ++k) {
    forget((*this)[k].points);
    forget((*this)[k].distances);
    forget((*this)[k].positions);
  }
}

}  // namespace rio
