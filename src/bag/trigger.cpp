// SPDX-License-Identifier: BSD-3-Clause
#include "trigger.hpp"

#include <algorithm>

namespace rio::bag {

void Triggers::add(std::uint32_t sequence, Time stamp, Time received) {
  triggers_[key(sequence)].push_back({received, stamp});
}

void Triggers::sort() {
  for (auto& [sequence, triggers] : triggers_) std::sort(triggers.begin(), triggers.end());
}

std::optional<Time> Triggers::find(std::uint32_t sequence, Time received) const {
  const auto with_key = triggers_.find(key(sequence));
  if (with_key == triggers_.end()) return std::nullopt;
  const std::vector<Trigger>& triggers = with_key->second;
  const auto after = std::upper_bound(triggers.begin(), triggers.end(), Trigger{received, Time(0)});
  if (after == triggers.begin()) return std::nullopt;
  return std::prev(after)->stamp;
}

}  // namespace rio::bag
