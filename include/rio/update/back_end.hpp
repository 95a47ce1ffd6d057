// SPDX-License-Identifier: BSD-3-Clause
// The contract of a back-end: what the pipeline asks of it, in the order of a scan. The filter
// (ekf/ekf.hpp) and the sliding window (smoother/smoother.hpp) fulfil it.
#pragma once

#include <concepts>
#include <cstddef>

#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/report.hpp"
#include "rio/update/scan_rows.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

/// What is void, besides the part of the state that a check replaces.
enum class Invalidates {
  kNothing,
  kLandmarks,  ///< they agree with the state before; the caller drops the trails
};

/// Stands in the concept for the lambdas with captures that replace() is called with; never called.
struct StateChange {
  std::size_t captured;
  void operator()(StateEstimate* estimate) const;
};

/// | stage       | member                                     | may change                        |
/// | ----------- | ------------------------------------------ | --------------------------------- |
/// | start       | reset(nav, P0)                             | everything                        |
/// |             | select_radar(r)                            | which radar's calibration is read |
/// | 1 propagate | propagate(time, imu, &gap) -> Status       | state and covariance; nothing if  |
/// |             |                                            | it returns kNumerical             |
/// |             | anchor(time) -> Time                       | nothing                           |
/// | checks      | replace(change, invalidates, report)       | what change(StateEstimate*) does, |
/// |             |                                            | the landmarks                     |
/// |             | drop_landmarks(report)                     | the landmarks                     |
/// | 5 update    | update(seen, rows) -> Status               | state and covariance; as          |
/// |             |                                            | predicted if it is kNumerical     |
/// | 6 promote   | maintain_landmarks(seen, rows, promotions, | the landmarks                     |
/// |             | report)                                    |                                   |
/// | 7 clone     | clone(scan)                                | the clones                        |
/// Between the calls, estimate() and state_estimate() are the mean and covariance at the newest
/// time. No member allocates after construction.
template <class B>
concept OdometryBackEnd = std::constructible_from<B, const Options&> &&
    requires(B b, const B& read, const NavState& nav, const BodyCovariance& P0, std::size_t radar,
             Time time, const ImuBuffer& imu, bool* gap, const Observations& seen,
             const ScanRows& rows, const Promotions& promotions, UpdateReport* report,
             const StateChange& change) {
  { read.estimate() } -> std::same_as<const Estimate&>;
  { read.state_estimate() } -> std::same_as<const StateEstimate&>;
  b.reset(nav, P0);
  b.select_radar(radar);
  { b.propagate(time, imu, gap) } -> std::same_as<Status>;
  { read.anchor(time) } -> std::same_as<Time>;
  b.replace(change, Invalidates::kLandmarks, report);
  b.drop_landmarks(report);
  { b.update(seen, rows) } -> std::same_as<Status>;
  b.maintain_landmarks(seen, rows, promotions, report);
  b.clone(ScanId{});
};

}  // namespace rio
