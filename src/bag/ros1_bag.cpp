// SPDX-License-Identifier: BSD-3-Clause
// ROS 1 bags, read from front to back: the index is not needed, and is missing if a recording was
// interrupted.
#include <chrono>
#include <cstring>
#include <map>
#include <string_view>

#include "chunk.hpp"
#include "formats.hpp"

namespace rio::bag {

namespace {

/// The fields of a record's header, or of a connection's data: name=value, each after its length.
class Fields {
 public:
  explicit Fields(Bytes header) {
    WireReader reader(header);
    while (reader.remaining() > 0) {
      const std::string_view field = reader.text();
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw Damage(0, "a header field without \"=\"");
      fields_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }

  std::string_view text(std::string_view name) const {
    const auto field = fields_.find(name);
    return field == fields_.end() ? std::string_view{} : field->second;
  }
  template <class T>
  T number(std::string_view name) const {
    const std::string_view value = text(name);
    if (value.size() != sizeof(T)) {
      throw Damage(0, "a record header without \"" + std::string(name) + "\"");
    }
    return number_at<T>(reinterpret_cast<const std::uint8_t*>(value.data()), false);
  }
  std::uint8_t op() const { return number<std::uint8_t>("op"); }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

class Ros1Bag final : public MessageStream {
 public:
  explicit Ros1Bag(const std::filesystem::path& path) : MessageStream(path), file_(path) {}

  std::string format() const override { return "ROS 1 bag"; }

 private:
  enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kChunk = 5, kConnection = 7 };

  bool read(Message* message) override {
    for (;;) {
      if (chunk_.more()) {
        const auto parse = [&](WireReader& reader) {
          const Fields fields(reader.block());
          return read_record(fields, reader.block(), message);
        };
        if (chunk_.parse(parse)) return true;
      } else if (offset_ >= file_.size()) {
        if (!closed_) throw Damage(offset_, "the recording was not closed: its end may be missing");
        return false;
      } else if (read_from_file(message)) {
        return true;
      }
    }
  }

  /// A message or a connection; true for a message.
  bool read_record(const Fields& fields, Bytes data, Message* message) {
    if (fields.op() == kConnection) add_connection(fields, data);
    if (fields.op() != kMessage) return false;
    const auto topic = connections_.find(fields.number<std::uint32_t>("conn"));
    if (topic == connections_.end()) throw Damage(0, "a message of an unknown connection");
    const auto time = fields.number<std::uint64_t>("time");  // seconds, then nanoseconds
    message->received = std::chrono::seconds(time & 0xFFFFFFFFU) + Time(time >> 32U);
    message->topic = topic->second;
    message->data = data;
    return true;
  }

  void add_connection(const Fields& fields, Bytes data) {
    const Fields about(data);
    const std::string_view name = fields.text("topic");
    connections_[fields.number<std::uint32_t>("conn")] =
        topic_index({std::string(name), std::string(about.text("type")), Encoding::kRos1,
                     std::string(about.text("message_definition"))});
  }

  /// The record at offset_; true if it is a message.
  bool read_from_file(Message* message) {
    const std::uint64_t start = offset_;
    const std::uint32_t header_size = length_at(start);
    if (header_size > kMaxHeader) throw Damage(start, "a record header of more than 1 MiB");
    file_.read(start + 4, header_size, &header_);
    const std::uint64_t data = start + 4 + header_size + 4;
    const std::uint32_t data_size = length_at(data - 4);
    try {
      const Fields fields(header_);
      offset_ = data + data_size;
      const std::uint8_t op = fields.op();
      if (op == kChunk) {
        chunk_.load(&file_, data, data_size, fields.text("compression"),
                    fields.number<std::uint32_t>("size"), 0);
        return false;
      }
      file_.expect(data, data_size);
      if (op == kBagHeader) closed_ = fields.number<std::uint64_t>("index_pos") != 0;
      if (op != kMessage && op != kConnection) return false;
      file_.read(data, data_size, &record_);
      return read_record(fields, record_, message);
    } catch (const Damage& damage) {
      throw Damage(damage.offset < start ? start : damage.offset, damage.what());
    }
  }

  std::uint32_t length_at(std::uint64_t offset) {
    std::vector<std::uint8_t> bytes;
    file_.read(offset, 4, &bytes);
    return number_at<std::uint32_t>(bytes.data(), false);
  }

  static constexpr std::uint32_t kMaxHeader = 1 << 20;

  FileBytes file_;
  std::uint64_t offset_ = std::strlen(kRos1Magic);
  bool closed_ = false;  ///< there is an index, so the recording is complete
  Chunk chunk_;
  std::vector<std::uint8_t> header_;
  std::vector<std::uint8_t> record_;
  std::map<std::uint32_t, std::size_t> connections_;  ///< number -> topic
};

}  // namespace

std::unique_ptr<MessageStream> open_ros1_bag(const std::filesystem::path& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace rio::bag
