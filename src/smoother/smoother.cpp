// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/smoother.hpp"

#include <algorithm>
#include <vector>

#include "rio/core/symmetric.hpp"

namespace rio {

Smoother::Smoother(const Options& options)
    : options_(options),
      state_estimate_(options, 0),
      window_(static_cast<std::size_t>(capacity(options)), options),
      system_(capacity(options), border_capacity()),
      prior_(state_estimate_.layout(), capacity(options)),
      factors_(options, state_estimate_.layout(), window_, &system_),
      solver_(options.smoother, capacity(options), border_capacity()),
      before_(static_cast<std::size_t>(capacity(options))),
      g_(Eigen::VectorXd::Zero(system_.capacity())),
      A_(Eigen::MatrixXd::Zero(system_.capacity(), system_.capacity())),
      P_(Eigen::MatrixXd::Zero(state_estimate_.layout().capacity(),
                               state_estimate_.layout().capacity())) {}

Status Smoother::propagate(Time to, const ImuBuffer& imu, bool* gap) {
  const Time from = estimate().nav.time;
  const Status status = state_estimate_.propagate(to, imu, gap);
  if (status != Status::kOk) return status;
  imu.for_each_step(from, to, [&](const ImuStep& step) { since_.step(step, options_.imu); });
  return Status::kOk;
}

Time Smoother::anchor(Time measured) const {
  const std::size_t i = window_.first_from(measured);
  return i < window_.size() ? window_[i].nav.time : estimate().nav.time;
}

void Smoother::drop_landmarks(UpdateReport* report) {
  for (std::size_t i = estimate().landmarks.size(); i-- > 0;) {
    remove_landmark(i);
    ++report->landmarks_removed;
  }
}

Status Smoother::update(const Observations& seen, const ScanRows& rows) {
  const bool appended = window_.newest().nav.time != estimate().nav.time;
  if (appended && !append()) return Status::kNumerical;
  const WindowState::Mark mark = window_.newest().mark();
  take(seen, rows);
  before_.save(window_, estimate());
  if (!solve()) {
    before_.restore(&window_, &state_estimate_.estimate());
    for (std::vector<AidingFactor>* kept : aided_) kept->pop_back();
    if (appended) window_.pop_newest();
    if (!appended) window_.newest().cut(mark);
    window_.newest().to_next.invalidate();
    return Status::kNumerical;
  }
  since_.reset(estimate().nav.gyro_bias, estimate().nav.accel_bias);
  while (window_.size() > static_cast<std::size_t>(options_.smoother.window)) {
    if (!marginalise_oldest()) {
      restart();
      return Status::kNumerical;
    }
  }
  return Status::kOk;
}

void Smoother::maintain_landmarks(const Observations& seen, const ScanRows& rows,
                                  const Promotions& promotions, UpdateReport* report) {
  rio::maintain_landmarks(
      seen, rows, promotions, options_, &state_estimate_.estimate(), report,
      [this](std::size_t i) { remove_landmark(i); },
      [this](std::size_t i) {
        return options_.smoother.keep_landmark_factors && window_.measures_landmark(i);
      },
      [this](const Detection& d) {
        window_.newest().measurements.add(Measured<LandmarkPointModel>{
            LandmarkPointModel::measurement(d), {}, estimate().radar, estimate().landmarks.size()});
        state_estimate_.add_landmark(d);
      });
}

void Smoother::restart() {
  state_estimate_.consider();
  since_considered_ = 0;
  window_.clear();
  window_.push();
  copy_newest();
  since_.reset(estimate().nav.gyro_bias, estimate().nav.accel_bias);
  const int n = state_estimate_.covariance().size();
  Eigen::Ref<Eigen::MatrixXd> P = P_.topLeftCorner(n, n);
  auto A = A_.topLeftCorner(n, n);
  // semi-definite: some directions are exact, and others so within the rounding of the sigmas
  double rounding = 1e-9;
  do {
    P = state_estimate_.covariance().matrix();
    P.diagonal().array() += kExact * kExact + rounding * P.diagonal().array();
    rounding *= 100.0;
  } while (!factorise_in_place(P) && rounding < 1.0);
  A.setIdentity();
  P.triangularView<Eigen::Lower>().solveInPlace(A);
  P.transpose().triangularView<Eigen::Upper>().solveInPlace(A);
  mirror_lower(A);
  g_.head(n).setZero();
  prior_.assign(A, g_.head(n), window_, 0, 1, estimate());
  window_.publish(&state_estimate_.estimate());
}

bool Smoother::append() {
  const ImuFactor factor(since_, options_.imu.gravity);
  if (!factor.valid()) return false;
  window_.newest().to_next = factor;
  window_.push();
  copy_newest();
  return true;
}

void Smoother::copy_newest() {
  WindowState& state = window_.newest();
  state.nav = estimate().nav;
  state.gyro_B = estimate().gyro_B;
  state.gyro_variance = estimate().gyro_variance;
  state.steady = estimate().steady;
  state.accel_B = state.nav.q_WB.conjugate() * state.steady.accel_W;
}

void Smoother::take(const Observations& seen, const ScanRows& rows) {
  aided_.clear();
  WindowState& state = window_.newest();
  WindowState::Scanned& scanned = state.scanned[estimate().radar];
  if (seen.scan != nullptr && !scanned.here) {
    scanned = {true, estimate().time_offset, estimate().doppler_scale};
    // a second radar's scan at nearly the same time was measured slightly later than the state
    const double offset = to_seconds(seen.scan->time - state.nav.time);
    if (state_estimate_.layout().radars() > 1) scanned.time_offset = offset;
  }
  state.measurements.append(rows.measurements());
  for (const std::size_t i : rows.aiding()) {
    const AidingObservation& aiding = (*seen.aiding)[i];
    // the newest, if the window has started over since
    WindowState& keeps = window_[std::min(window_.first_from(aiding.anchor), window_.size() - 1)];
    const bool anchored = keeps.nav.time == aiding.anchor;
    if (keeps.aiding.size() == kMaxAiding) continue;  // full: recorded as used, but left out
    keeps.aiding.push_back({aiding.measurement, anchored ? aiding.to_anchor : aiding.to_now});
    (void)aided_.push_back(&keeps.aiding);
  }
}

bool Smoother::solve() {
  const auto build = [this] {
    const double cost = begin_with_prior();
    return cost + factors_.add_all(estimate());
  };
  if (!solver_.minimise(build, &system_, &window_, &state_estimate_)) return false;
  auto P = P_.topLeftCorner(system_.tail_size(), system_.tail_size());
  if (!system_.tail_covariance(&P_) || !P.allFinite()) return false;
  state_estimate_.covariance().matrix() = P;
  return true;
}

double Smoother::begin_with_prior() {
  system_.clear(static_cast<int>(window_.size()),
                state_estimate_.covariance().size() - body::kSize);
  return prior_.add_to(&system_, window_, estimate());
}

bool Smoother::marginalise_oldest() {
  begin_with_prior();
  factors_.add_imu(0);
  factors_.add_scan(0, estimate());
  factors_.add_aiding(0, estimate());
  const ScanId oldest = window_[0].scan;
  for (std::size_t k = 1; k < window_.size(); ++k) {
    std::erase_if(window_[k].measurements.of<TrailDistanceModel>(), [&](const auto& m) {
      if (m.past == oldest) factors_.add_trail(k, m, estimate());
      return m.past == oldest;
    });
  }
  int leading = 0;
  if (!system_.eliminate_oldest(&leading, &A_, &g_)) return false;
  const int n = body::kSize * leading + system_.border();
  prior_.assign(A_.topLeftCorner(n, n), g_.head(n), window_, 1, leading, estimate());
  prior_.add_landmark_noise(estimate(), window_[1].nav.p_WB, options_.update.landmark_walk,
                            (window_[1].nav.p_WB - window_[0].nav.p_WB).norm());
  prior_.add_parameter_noise(state_estimate_.parameters().walk,
                             to_seconds(window_[1].nav.time - window_[0].nav.time));
  if (++since_considered_ >= options_.smoother.window) {  // it costs a factorisation
    prior_.consider(state_estimate_.parameters().prior);
    since_considered_ = 0;
  }
  window_.pop_oldest();
  window_.publish(&state_estimate_.estimate());
  return true;
}

void Smoother::remove_landmark(std::size_t i) {
  const std::size_t last = estimate().landmarks.size() - 1;
  prior_.remove_landmark(i, last);
  window_.forget_landmark(i, last);
  state_estimate_.remove_landmark(i);
}

}  // namespace rio
