// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "rio/bag/point_fields.hpp"

namespace rio::bag {

namespace {

void add_header(const Header& header, Time received, TopicSummary* s) {
  if (s->messages == 1) s->frame_id = header.frame_id;
  if (header.stamp.count() == 0) {
    ++s->zero_stamps;
    return;
  }
  const double delay = to_seconds(received - header.stamp);
  s->min_delay = std::min(s->min_delay, delay);
  s->max_delay = std::max(s->max_delay, delay);
}

void add(const Message& message, TopicSummary* s) {
  if (s->messages == 0) s->first = s->last = message.received;
  ++s->messages;
  s->first = std::min(s->first, message.received);
  s->last = std::max(s->last, message.received);
  const bool points = is_cloud(s->topic.type) && s->topic.encoding != Encoding::kOther;
  if (!s->has_header && !points) return;
  try {
    if (points && s->fields.empty()) {
      s->fields = decode_cloud_of(s->topic, message.data).fields;
    }
    if (!s->has_header) return;
    const Header header = decode_header(s->topic.encoding, message.data);
    add_header(header, message.received, s);
    if (header.stamp != Time(0) && header.stamp < s->latest_stamp) {
      ++s->behind;
      s->longest_behind = std::max(s->longest_behind, to_seconds(s->latest_stamp - header.stamp));
    }
    s->latest_stamp = std::max(s->latest_stamp, header.stamp);
  } catch (const Damage&) {
    ++s->unreadable;
  }
}

std::string clock_text(const TopicSummary& s) {
  std::string zero =
      s.zero_stamps == 0 ? "" : fmt::format("{} of {} are zero", s.zero_stamps, s.messages);
  if (s.min_delay > s.max_delay) return zero;
  if (s.behind > 0) {
    zero += fmt::format("{}{} are before an earlier one, by up to {:.3f} s",
                        zero.empty() ? "" : "; ", s.behind, s.longest_behind);
  }
  return fmt::format("{:.6f} to {:.6f} s before they were received{}", s.min_delay, s.max_delay,
                     zero.empty() ? "" : "; " + zero);
}

/// How the points would be read without any settings.
std::string match_text(const TopicSummary& s) {
  try {
    return PointMap(s.fields, {}).text();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

std::string topic_text(const TopicSummary& s, std::size_t width) {
  const double span = to_seconds(s.last - s.first);
  const std::string rate =
      span > 0.0 ? fmt::format("{:8.2f} Hz", static_cast<double>(s.messages - 1) / span) : "";
  std::string text = fmt::format("{:<{}}  {:<28} {:7} {:>11} {:9.3f} s\n", s.topic.name, width,
                                 s.topic.type, s.messages, rate, span);
  if (s.topic.encoding == Encoding::kOther) text += "    neither ROS 1 nor CDR\n";
  if (s.unreadable > 0) {
    text += fmt::format("    {} of its messages are damaged\n", s.unreadable);
  }
  if (s.has_header && s.unreadable < s.messages) {
    text += fmt::format("    header stamps {}; frame_id \"{}\"\n", clock_text(s), s.frame_id);
  }
  if (!s.fields.empty()) {
    text += "    fields: " + fields_text(s.fields) + "\n    points " + match_text(s) + "\n";
  }
  return text;
}

}  // namespace

Summary summarise(MessageStream* stream, const std::function<void(const Message&)>& use) {
  Summary summary;
  summary.format = stream->format();
  Message message;
  while (stream->next(&message)) {
    while (summary.topics.size() < stream->topics().size()) {
      TopicSummary s;
      s.topic = stream->topics()[summary.topics.size()];
      s.has_header = begins_with_header(s.topic);
      summary.topics.push_back(std::move(s));
    }
    add(message, &summary.topics[message.topic]);
    if (use) use(message);
  }
  summary.damage = stream->damage();
  return summary;
}

std::string summary_text(const Summary& summary) {
  std::size_t messages = 0;
  std::size_t width = 0;
  Time first = Time::max();
  Time last = Time::min();
  for (const TopicSummary& s : summary.topics) {
    width = std::max(width, s.topic.name.size());
    if (s.messages == 0) continue;
    messages += s.messages;
    first = std::min(first, s.first);
    last = std::max(last, s.last);
  }
  std::string text = fmt::format("{}, {} messages", summary.format, messages);
  if (messages > 0) {
    text += fmt::format(", {:.3f} s, received from {}.{:09} s on", to_seconds(last - first),
                        first.count() / 1'000'000'000, first.count() % 1'000'000'000);
  }
  text += "\n";
  for (const TopicSummary& s : summary.topics) text += topic_text(s, width);
  return text;
}

}  // namespace rio::bag
