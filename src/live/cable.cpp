// SPDX-License-Identifier: BSD-3-Clause
#include "live/cable.hpp"

#include <algorithm>
#include <utility>

namespace rio::live {
namespace {

constexpr double kDelay = 0.02;    // [s]
constexpr std::size_t kRun = 64;   // [bytes]
constexpr std::size_t kParts = 5;  // at most
constexpr Time kApart = std::chrono::milliseconds(1);

}  // namespace

bool Cable::happens(double share) {
  return std::bernoulli_distribution(share)(random_);
}

std::size_t Cable::draw(std::size_t least, std::size_t most) {
  return std::uniform_int_distribution<std::size_t>(least, most)(random_);
}

void Cable::send(Bytes packet, Time due) {
  ++counters_.packets;
  if (happens(noise_.dropped)) {
    ++counters_.dropped;
    return;
  }
  if (happens(noise_.damaged)) {
    ++counters_.damaged;
    const std::size_t length = draw(1, std::min(kRun, packet.size()));
    const auto begin =
        packet.begin() + static_cast<std::ptrdiff_t>(draw(0, packet.size() - length));
    packet.erase(begin, begin + static_cast<std::ptrdiff_t>(length));
  }
  if (happens(noise_.delayed)) {
    ++counters_.delayed;
    due += from_seconds(std::exponential_distribution<double>(1.0 / kDelay)(random_));
  }
  if (!pieces_.empty()) due = std::max(due, pieces_.back().due);
  if (packet.size() > kParts && happens(noise_.split)) {
    ++counters_.split;
    cut(packet, due);
  } else {
    pieces_.push_back({due, std::move(packet)});
  }
}

void Cable::cut(const Bytes& packet, Time due) {
  const std::size_t parts = draw(2, kParts);
  std::vector<std::size_t> ends{packet.size()};
  for (std::size_t i = 1; i < parts; ++i) ends.push_back(draw(1, packet.size() - 1));
  std::sort(ends.begin(), ends.end());
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    const auto at = packet.begin();
    pieces_.push_back({due, Bytes(at + static_cast<std::ptrdiff_t>(begin),
                                  at + static_cast<std::ptrdiff_t>(end))});
    begin = end;
    due += kApart;
  }
}

}  // namespace rio::live
