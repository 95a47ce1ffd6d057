// SPDX-License-Identifier: BSD-3-Clause
#include "scan_history.hpp"

#include <algorithm>
#include <utility>

namespace rio {

void ScanHistory::forget(std::optional<Time> now) {
  for (OfRadar& own : of_) {
    own.processed = false;
    own.newest.reset();
    own.heard = now;
  }
}

void ScanHistory::forget_fingerprints() {
  for (OfRadar& own : of_) own.fingerprint = 0;
}

bool ScanHistory::is_repeated(const DetectionList& scan) {
  OfRadar& own = of_[scan.radar];
  const std::uint64_t before = std::exchange(own.fingerprint, fingerprint(scan));
  return own.fingerprint != 0 && own.fingerprint == before;
}

bool ScanHistory::is_ready(Time measured, std::size_t radar, Time now) const {
  if (measured > now) return false;
  if (now - measured >= wait_) return true;
  for (std::size_t r = 0; r < radars_; ++r) {
    const OfRadar& other = of_[r];
    const bool heard = other.heard && now - *other.heard < kSilent;
    if (r != radar && heard && !(other.newest >= measured)) return false;
  }
  return true;
}

void ScanHistory::take(std::size_t radar, Time measured, std::optional<Time> now) {
  OfRadar& own = of_[radar];
  own.newest = std::max(own.newest.value_or(measured), measured);
  if (now) own.heard = now;
}

void ScanHistory::process(Time stamp, std::size_t radar, Time estimate) {
  of_[radar].last = stamp;
  of_[radar].processed = true;
  last_radar_ = radar;
  last_estimate_ = estimate;
}

}  // namespace rio
