// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/window_factors.hpp"

namespace rio {

WindowFactors::WindowFactors(const Options& options, const Layout& layout, const Window& window,
                             NormalEquations* system)
    : options_(options.smoother),
      auxiliary_(options.auxiliary),
      gravity_(options.imu.gravity),
      layout_(layout),
      window_(window),
      system_(system),
      models_(options.update),
      scan_(options.smoother, system),
      row_(1) {}

double WindowFactors::add_all(const Estimate& x) {
  double cost = 0.0;
  for (std::size_t k = 0; k < window_.size(); ++k) {
    if (k + 1 < window_.size()) cost += add_imu(k);
    cost += add_scan(k, x);
    cost += add_aiding(k, x);
    for (const auto& m : window_[k].measurements.of<TrailDistanceModel>()) {
      cost += add_trail(k, m, x);
    }
  }
  return cost;
}

double WindowFactors::add_imu(std::size_t k) {
  ImuFactor::Residual r;
  ImuFactor::Jacobian J;
  window_[k].to_next.evaluate(window_[k].nav, window_[k + 1].nav, &r, &J);
  system_->add_between(static_cast<int>(k), J, r);
  return 0.5 * r.squaredNorm();
}

double WindowFactors::add_scan(std::size_t k, const Estimate& estimate) {
  double cost = 0.0;
  for (std::size_t r = 0; r < layout_.radars(); ++r) {
    if (window_[k].scanned[r].here) cost += add_scan_of(k, r, estimate);
  }
  return cost;
}

double WindowFactors::add_scan_of(std::size_t k, std::size_t r, const Estimate& estimate) {
  const WindowState& state = window_[k];
  const LinearizationPoint x = point(state, r, estimate);
  const WindowLayout layout = layout_of(k, r);
  scan_.begin(layout);
  const SteadyOffset steady = x.steady_offset();
  for (Measured<DopplerModel> m : state.measurements.of<DopplerModel>()) {
    if (m.radar != r) continue;
    m.z.steady = steady;
    add(m, x, layout);
  }
  scan_.share_rate_noise(state.gyro_variance);
  state.measurements.for_each([&]<class M>(Measured<M> m) {
    if constexpr (!std::is_same_v<M, DopplerModel> && !M::Blocks::template has<ClonePose>()) {
      if (m.radar != r) return;
      if constexpr (std::is_same_v<M, LandmarkPointModel>) {
        if (m.doppler) m.doppler->steady = steady;
      }
      add(m, x, layout);
    }
  });
  return scan_.end();
}

template <class M>
void WindowFactors::add(const Measured<M>& m, const LinearizationPoint& x,
                        const WindowLayout& layout) {
  BlockIndex index;
  int landmark_column = -1;
  if constexpr (M::Blocks::template has<Landmark>()) {
    index.landmark = static_cast<int>(m.landmark);
    landmark_column = layout.column<Landmark>(index.landmark);
  }
  bool valid = scan_.push(models_.of<M>(), m.z, typename M::Blocks{}, x, index);
  if constexpr (std::is_same_v<M, LandmarkPointModel>) {
    using Doppler = LandmarkDopplerModel;
    if (valid && m.doppler) {
      valid = scan_.push(models_.of<Doppler>(), *m.doppler, Doppler::Blocks{}, x, index);
    }
  }
  if (!valid) return scan_.drop();
  scan_.close(m.weight, landmark_column);
}

double WindowFactors::add_aiding(std::size_t k, const Estimate& estimate) {
  double cost = 0.0;
  for (const AidingFactor& f : window_[k].aiding) {
    if (!linearize(f.measurement, f.since, window_[k].nav, estimate, auxiliary_, gravity_,
                   aiding_columns(layout_of(k, f.measurement.radar())), &aiding_)) {
      continue;
    }
    double chi_squared = 0.0;
    for (const LinearRow& row : aiding_) chi_squared += row.residual * row.residual;
    const KernelValue value = evaluate_kernel(
        options_.kernel, options_.kernel_size * static_cast<double>(aiding_.size()), chi_squared);
    for (const LinearRow& row : aiding_) system_->add(row, value.weight);
    cost += 0.5 * value.cost;
  }
  return cost;
}

double WindowFactors::add_trail(std::size_t k, const Measured<TrailDistanceModel>& m,
                                const Estimate& estimate) {
  const int past = window_.find(m.past);
  if (past < 0) return 0.0;
  const LinearizationPoint x = point(window_[k], m.radar, estimate);
  row_.clear();
  row_.begin_block();
  using Trail = TrailDistanceModel;
  if (!linearize(models_.of<Trail>(), m.z, Trail::Blocks{}, x, {past, 0}, layout_of(k, m.radar),
                 &row_)) {
    return 0.0;
  }
  const LinearRow& row = row_.rows().front();
  const double size =
      options_.trail_kernel_size > 0.0 ? options_.trail_kernel_size : options_.kernel_size;
  const KernelValue value =
      evaluate_kernel(options_.kernel, size, row.residual * row.residual / row.variance);
  system_->add(row, value.weight);
  return 0.5 * value.cost;
}

LinearizationPoint WindowFactors::point(const WindowState& state, std::size_t r,
                                        const Estimate& estimate) {
  SteadyMotion steady = state.steady;
  steady.accel_W = state.nav.q_WB * state.accel_B;
  LinearizationPoint x(estimate, state.nav, state.gyro_B, steady);
  const RadarState& now = estimate.of_radar(r);
  const WindowState::Scanned& scanned = state.scanned[r];
  x.T_BS = RigidPose(now.T_BS);
  x.doppler_scale = now.doppler_scale - scanned.doppler_scale;
  x.elevation_error = now.elevation_error;
  const double later = now.time_offset - scanned.time_offset;
  if (state.at_rest()) {
    x.stand();
  } else if (later != 0.0) {
    x.step_back(later);
  }
  return x;
}

}  // namespace rio
