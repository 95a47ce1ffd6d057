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
      reliable_(options.update.doppler_directions == DopplerDirections::kReliable),
      doppler_(options.update.doppler_directions),
      trail_(options.update.sigma_trail_distance),
      distance_(options.update.sigma_landmark_distance),
      scan_(options.smoother, system),
      row_(1) {}

double WindowFactors::add_all(const Estimate& x) {
  double cost = 0.0;
  for (std::size_t k = 0; k < window_.size(); ++k) {
    if (k + 1 < window_.size()) cost += add_imu(k);
    cost += add_scan(k, x);
    cost += add_aiding(k, x);
    for (const TrailFactor& f : window_[k].trails) cost += add_trail(k, f, x);
  }
  return cost;
}

double WindowFactors::add_imu(std::size_t k) {
  ImuFactor::Residual r;
  ImuFactor::Jacobian J;
  window_[k].to_next.evaluate(InertialState(window_[k].nav), InertialState(window_[k + 1].nav), &r,
                              &J);
  system_->add_between(static_cast<int>(k), J, r);
  return 0.5 * r.squaredNorm();
}

double WindowFactors::add_scan(std::size_t k, const Estimate& estimate) {
  const WindowState& state = window_[k];
  double cost = 0.0;
  bool rest = state.rest.has_value();
  for (std::size_t r = 0; r < layout_.radars(); ++r) {
    if (!state.scanned[r].here) continue;
    cost += add_scan_of(k, r, rest, estimate);
    rest = false;
  }
  return cost;
}

double WindowFactors::add_scan_of(std::size_t k, std::size_t r, bool rest,
                                  const Estimate& estimate) {
  const WindowState& state = window_[k];
  const LinearizationPoint x = point(state, r, estimate);
  const WindowLayout layout = layout_of(k, r);
  const auto add = [&](const auto& model, const auto& z, double weight) {
    if (scan_.push(model, z, x, {})) scan_.close(weight);
  };
  const auto add_of_landmark = [&](const auto& factor, const auto& push) {
    const int landmark = static_cast<int>(factor.landmark);
    if (!push(BlockIndex{0, landmark})) return scan_.drop();
    scan_.close(factor.weight, layout.column<Landmark>(landmark));
  };
  scan_.begin(layout);
  Reliability reliability;
  if (reliable_) {
    for (const DopplerFactor& f : state.dopplers) {
      if (f.radar == r) reliability.add(f.doppler, x.radar_velocity_S());
    }
  }
  const Matrix3d believed = reliability.matrix();
  for (const DopplerFactor& f : state.dopplers) {
    if (f.radar != r) continue;
    DopplerModel::Measurement z = f.doppler;
    z.reliability = believed;
    add(doppler_, z, f.weight);
  }
  for (const PointFactor& f : state.points) {
    if (f.radar != r) continue;
    add_of_landmark(f, [&](BlockIndex index) {
      return scan_.push(LandmarkPointModel{}, f.point, x, index) &&
             (!f.doppler || scan_.push(LandmarkDopplerModel{}, *f.doppler, x, index));
    });
  }
  for (const DistanceFactor& f : state.distances) {
    if (f.radar != r) continue;
    add_of_landmark(f,
                    [&](BlockIndex index) { return scan_.push(distance_, f.distance, x, index); });
  }
  for (const PositionFactor& f : state.positions) {
    if (f.radar != r) continue;
    add_of_landmark(f, [&](BlockIndex index) {
      return scan_.push(LandmarkPositionModel{}, f.position, x, index);
    });
  }
  if (rest) add(RestModel{}, *state.rest, 1.0);
  return scan_.end();
}

double WindowFactors::add_aiding(std::size_t k, const Estimate& estimate) {
  double cost = 0.0;
  for (const AidingFactor& f : window_[k].aiding) {
    if (!linearize(f.measurement, f.since, window_[k].nav, auxiliary_, estimate.auxiliary, gravity_,
                   layout_of(k).aiding_columns(), &aiding_)) {
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

double WindowFactors::add_trail(std::size_t k, const TrailFactor& f, const Estimate& estimate) {
  const int past = window_.find(f.past);
  if (past < 0) return 0.0;
  row_.clear();
  row_.begin_block();
  if (!linearize(trail_, f.distance, TrailDistanceModel::Blocks{},
                 point(window_[k], f.radar, estimate), {past, 0}, layout_of(k, f.radar), &row_)) {
    return 0.0;
  }
  const LinearRow& row = row_.rows().front();
  const KernelValue value = evaluate_kernel(options_.kernel, options_.kernel_size,
                                            row.residual * row.residual / row.variance);
  system_->add(row, value.weight);
  return 0.5 * value.cost;
}

LinearizationPoint WindowFactors::point(const WindowState& state, std::size_t r,
                                        const Estimate& estimate) {
  LinearizationPoint x(estimate, state.nav, state.gyro_B, state.nav.q_WB * state.accel_B);
  const RadarState now = estimate.of_radar(r);
  const WindowState::Scanned& scanned = state.scanned[r];
  x.T_BS = RigidPose(now.T_BS);
  x.radar_errors = now.errors - scanned.radar_errors;
  const double later = now.time_offset - scanned.time_offset;
  if (state.rest) {
    x.stand();
  } else if (later != 0.0) {
    x.step_back(later);
  }
  return x;
}

}  // namespace rio
