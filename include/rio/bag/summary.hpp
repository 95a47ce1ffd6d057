// SPDX-License-Identifier: BSD-3-Clause
// Contents of a recording: topics, rates, clocks, point fields.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "rio/bag/message_stream.hpp"
#include "rio/bag/messages.hpp"

namespace rio::bag {

struct TopicSummary {
  Topic topic;
  std::size_t messages = 0;
  Time first{0};  ///< receive clock
  Time last{0};
  bool has_header = false;
  std::size_t zero_stamps = 0;  ///< of headers
  double min_delay =
      std::numeric_limits<double>::infinity();  ///< receive - header, not of zeros [s]
  double max_delay = -std::numeric_limits<double>::infinity();
  Time latest_stamp{0};            ///< of the headers
  std::size_t behind = 0;          ///< headers before the latest one so far
  double longest_behind = 0.0;     ///< [s]
  std::string frame_id;            ///< of the first message
  std::vector<PointField> fields;  ///< of the first cloud that has any
  std::size_t unreadable = 0;      ///< messages that could not be decoded
};

struct Summary {
  std::string format;
  std::vector<TopicSummary> topics;
  std::string damage;  ///< of the stream
};

/// Reads the stream to its end.
/// @param use called with every message, unless empty
Summary summarise(MessageStream* stream, const std::function<void(const Message&)>& use = {});

/// Text for people: a line per topic, followed by its special properties.
std::string summary_text(const Summary& summary);

}  // namespace rio::bag
