// SPDX-License-Identifier: BSD-3-Clause
// Stamps of scans from their hardware trigger messages.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "rio/bag/recording.hpp"
#include "rio/types.hpp"

namespace rio::bag {

class Triggers {
 public:
  explicit Triggers(TriggerMatch match) : match_(match) {}

  /// In any order.
  /// @param stamp the stamp of the scan that it triggered
  void add(std::uint32_t sequence, Time stamp, Time received);
  /// Once, before find().
  void sort();
  /// The stamp of the last trigger that was received before a scan: of any, or of those with its
  /// sequence number.
  std::optional<Time> find(std::uint32_t sequence, Time received) const;

 private:
  struct Trigger {
    Time received;
    Time stamp;
    bool operator<(const Trigger& other) const { return received < other.received; }
  };
  std::uint32_t key(std::uint32_t sequence) const {
    return match_ == TriggerMatch::kSequence ? sequence : 0;
  }
  TriggerMatch match_;
  std::map<std::uint32_t, std::vector<Trigger>> triggers_;
};

}  // namespace rio::bag
