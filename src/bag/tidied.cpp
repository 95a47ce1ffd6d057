// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "decompress.hpp"
#include "formats.hpp"
#include "rio/bag/messages.hpp"
#include "rio/bag/wire.hpp"

namespace rio::bag {

namespace {

constexpr std::size_t kMostPoints = 4096;  // of a scan

class Tidied final : public MessageStream {
 public:
  explicit Tidied(std::unique_ptr<MessageStream> raw)
      : MessageStream(raw->path()), raw_(std::move(raw)) {}

  std::string format() const override { return raw_->format(); }

 private:
  /// Messages of one topic with the same frame_id.
  struct Framed {
    std::size_t topic = 0;
    std::string frame;  ///< empty: not known yet
  };
  /// Of a topic of the file.
  struct State {
    bool points = false;         ///< of scans, one a message
    std::vector<Framed> frames;  ///< of its messages
    Time last{0};                ///< received, on the clock that goes on
    Time last_but_one{0};
    std::size_t count = 0;
    std::vector<std::uint8_t> scan;  ///< so far
    std::size_t points_of_scan = 0;
    TiPoint last_point;
    Time received{0};  ///< of the first point
  };

  bool read(Message* message) override {
    while (next_raw(message)) {
      while (states_.size() < raw_->topics().size()) {
        topics_.push_back(raw_->topics()[states_.size()]);
        states_.emplace_back().points = is_ti_scan(topics_.back().type);
        states_.back().frames.push_back({topics_.size() - 1, {}});
      }
      State& of = states_[message->topic];
      const std::string_view packed = compression_of(message->data);
      if (raw_->topics()[message->topic].encoding == Encoding::kCdr && !packed.empty()) {
        if (!decompress(packed, message->data, {}, &plain_).empty()) plain_.clear();
        message->data = plain_;
      }
      set_clock(&of, message);
      if (of.points && !take_point(&of, message)) continue;
      message->topic = topic_of(&of, message);
      return true;
    }
    damage_ = raw_->damage();
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i].scan.empty()) continue;
      give_scan(&states_[i], message);
      message->topic = states_[i].frames[0].topic;
      return true;
    }
    return false;
  }

  /// Empty if the message has none, or cannot be read.
  std::string frame_of(const Topic& topic, Bytes data) const {
    if (!(topic.type == kImuType || is_cloud(topic.type)) || !begins_with_header(topic)) return {};
    try {
      return decode_header(topic.encoding, data).frame_id;
    } catch (const Damage&) {
      return {};
    }
  }

  /// IMUs or radars that share a topic are told apart by their frames: the first has its name, any
  /// other one TOPIC@FRAME. They come by turns; else one has changed its frame.
  std::size_t topic_of(State* of, Message* message) {
    constexpr std::size_t kMost = 8;   // of a driver that counts in it
    constexpr std::size_t kTurns = 8;  // messages
    const std::size_t raw = message->topic;
    const std::string frame = frame_of(raw_->topics()[raw], message->data);
    Framed& first = of->frames[0];
    if (first.frame.empty()) first.frame = frame;
    for (const Framed& known : of->frames) {
      if (known.frame == frame) return known.topic;
    }
    if (frame.empty() || of->frames.size() == kMost) return first.topic;
    bool by_turns = false;
    std::size_t later = 0;
    look_ahead(message, [&](const Waiting& next) {
      const std::string other = frame_of(raw_->topics()[raw], next.data);
      by_turns = std::ranges::any_of(of->frames, [&](const Framed& f) { return f.frame == other; });
      return !by_turns && ++later < kTurns;
    });
    of->frames.push_back({by_turns ? topics_.size() : first.topic, frame});
    if (!by_turns) return of->frames.back().topic;
    const Topic& topic = raw_->topics()[raw];
    topics_.push_back({topic.name + "@" + frame, topic.type, topic.encoding, topic.definition});
    return topics_.size() - 1;
  }

  bool next_raw(Message* message) {
    if (waiting_.empty()) return raw_->next(message);
    held_ = std::move(waiting_.front());
    waiting_.pop_front();
    *message = {held_.topic, held_.received, held_.data};
    return true;
  }

  /// A step back, unless it ends one stray time or the times fill a hole (a file that is not in the
  /// order of its times), and one ahead by more than any pause of a flight (a computer that began
  /// in 1970) are made good: for all topics, by the usual interval of the first topic that shows
  /// it.
  void set_clock(State* of, Message* message) {
    constexpr Time kPause = std::chrono::hours(1);
    constexpr Time kFar(300'000'000);
    constexpr Time kBack(50'000'000);  // messages that are swapped are nearer
    message->received += ahead_;
    if (message->received - newest_ > kFar) hole_ = {newest_, message->received};
    const bool fills = message->received > hole_.begin && message->received < hole_.end &&
                       message->received - hole_.begin <= kFar;
    if (fills) hole_.begin = message->received;
    const Time back = fills ? Time(0) : std::min(of->last, of->last_but_one) - message->received;
    const bool is_back = back > kBack && (back > kFar || is_kept(message, of->last));
    const bool is_ahead = message->received - std::max(of->last, latest_) > kPause;
    if (of->count > 1 && (is_back || is_ahead)) {
      const Time step = of->last + (of->last - of->last_but_one) - message->received;
      ahead_ += step;
      message->received += step;
    }
    of->last_but_one = std::exchange(of->last, message->received);
    latest_ = message->received;
    newest_ = std::max(newest_, latest_);
    ++of->count;
  }

  /// Calls use(later message of the same topic of the file) until that is false, or for some
  /// hundred messages.
  template <class Use>
  void look_ahead(Message* message, const Use& use) {
    constexpr std::size_t kMost = 256;  // of all topics
    here_.assign(message->data.begin(), message->data.end());
    message->data = here_;
    for (std::size_t i = 0;; ++i) {
      if (i == waiting_.size()) {
        Message next;
        if (i == kMost || !raw_->next(&next)) return;
        waiting_.push_back({next.topic, next.received, {next.data.begin(), next.data.end()}});
      }
      if (waiting_[i].topic == message->topic && !use(waiting_[i])) return;
    }
  }

  /// Whether the next messages of the topic were received before `last` as well: none that was
  /// late.
  bool is_kept(Message* message, Time last) {
    constexpr std::size_t kLater = 3;
    std::size_t later = 0;
    look_ahead(message, [&](const Waiting& next) {
      return next.received + ahead_ <= last && ++later < kLater;
    });
    return later == kLater;
  }

  /// True if a scan is complete, which replaces the message.
  bool take_point(State* of, Message* message) {
    const auto read = ti_point(raw_->topics()[message->topic].encoding, message->data);
    const bool counts_on = read && read->id > of->last_point.id;
    const bool uncounted = read && read->id == 0 && of->last_point.id == 0 &&  // of all points
                           read->stamp == of->last_point.stamp && read->stamp != Time(0);
    const bool begins = !(counts_on || uncounted) || of->points_of_scan == kMostPoints;
    const Message point = *message;
    bool complete = false;
    if (begins && !of->scan.empty()) {
      give_scan(of, message);
      complete = true;
    }
    if (of->scan.empty()) of->received = point.received;
    const auto size = static_cast<std::uint32_t>(point.data.size());
    for (unsigned shift = 0; shift < 32; shift += 8) {
      of->scan.push_back(static_cast<std::uint8_t>(size >> shift));
    }
    of->scan.insert(of->scan.end(), point.data.begin(), point.data.end());
    of->last_point = read.value_or(TiPoint{});
    ++of->points_of_scan;
    return complete;
  }

  void give_scan(State* of, Message* message) {
    given_ = std::exchange(of->scan, {});
    of->points_of_scan = 0;
    message->received = of->received;
    message->data = given_;
  }

  /// A message read before its turn.
  struct Waiting {
    std::size_t topic = 0;
    Time received{0};
    std::vector<std::uint8_t> data;
  };

  std::unique_ptr<MessageStream> raw_;
  std::deque<Waiting> waiting_;
  Waiting held_;                    ///< the last one that waited
  std::vector<std::uint8_t> here_;  ///< copy of the message at hand
  std::deque<State> states_;
  std::vector<std::uint8_t> plain_;  ///< decompressed message
  std::vector<std::uint8_t> given_;  ///< scan
  Time ahead_{0};                    ///< added to receive times
  Time latest_{0};                   ///< receive time of the message before
  struct {
    Time begin{0};
    Time end{0};
  } hole_;          ///< the last one between receive times
  Time newest_{0};  ///< receive time so far
};

}  // namespace

std::unique_ptr<MessageStream> tidied(std::unique_ptr<MessageStream> raw) {
  return std::make_unique<Tidied>(std::move(raw));
}

}  // namespace rio::bag
