// SPDX-License-Identifier: BSD-3-Clause
// The contract of a front-end: what the pipeline asks of it, in the order of a scan. `Frontend`
// (frontend/frontend.hpp) fulfils it; one with an ego-velocity estimator of its own holds a
// Frontend and leaves the matching and the trails to it (example 05). C++20.
#pragma once

#include <concepts>
#include <cstddef>

#include "rio/frontend/frontend.hpp"

namespace rio {

/// | stage       | member                                    | may change                         |
/// | ----------- | ----------------------------------------- | ---------------------------------- |
/// | start       | reset()                                   | forgets the trails                 |
/// | 2 front-end | observe(scan, predicted, &seen, cov)      | nothing that a second call for the |
/// |             |                                           | same scan would see                |
/// | 6 promote   | advance(seen, scan, room, &promotions)    | the trails                         |
/// trails() are those that the last observe() matched; they are valid until the next reset() or
/// advance(). There is one front-end for each radar, made from Options::seen_by. No member
/// allocates after construction.
template <class F>
concept OdometryFrontEnd = std::constructible_from<F, const Options&> && std::movable<F> &&
    requires(F f, const F& read, const DetectionList& scan, const Estimate& predicted,
             Observations* out, const Matrix3d& velocity_covariance_S, const Observations& seen,
             std::size_t room, Promotions* promotions) {
  f.reset();
  f.observe(scan, predicted, out, velocity_covariance_S);
  f.advance(seen, ScanId{}, room, promotions);
  { read.trails() } -> std::same_as<const TrailSet&>;
};

}  // namespace rio
