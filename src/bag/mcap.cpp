// SPDX-License-Identifier: BSD-3-Clause
// MCAP files, read from front to back up to the end of the data section.
#include <algorithm>
#include <cstring>
#include <map>
#include <utility>

#include "chunk.hpp"
#include "formats.hpp"

namespace rio::bag {

namespace {

class Mcap final : public MessageStream {
 public:
  explicit Mcap(const std::filesystem::path& path) : MessageStream(path), file_(path) {}

  std::string format() const override { return "MCAP"; }

 private:
  using enum mcap::Op;

  bool read(Message* message) override {
    for (;;) {
      if (chunk_.more()) {
        const auto parse = [&](WireReader& reader) {
          const auto op = reader.read<std::uint8_t>();
          const Bytes record = reader.skip(reader.read<std::uint64_t>());
          return read_record(op, record, message);
        };
        if (chunk_.parse(parse)) return true;
      } else if (at_end_) {
        return false;
      } else if (read_from_file(message)) {
        return true;
      }
    }
  }

  /// A schema, a channel or a message; true for a message.
  bool read_record(std::uint8_t op, Bytes record, Message* message) {
    WireReader reader(record);
    if (op == kSchema) {
      const auto id = reader.read<std::uint16_t>();
      const std::string name(reader.text());
      (void)reader.text();  // language of the definition
      schemas_[id] = {ros1_type(name), std::string(reader.text())};
    } else if (op == kChannel) {
      const auto id = reader.read<std::uint16_t>();
      const auto& [type, definition] = schemas_[reader.read<std::uint16_t>()];
      const std::string name(reader.text());
      const std::string_view encoding = reader.text();
      channels_[id] = topic_index({name, type,
                                   encoding == "cdr"    ? Encoding::kCdr
                                   : encoding == "ros1" ? Encoding::kRos1
                                                        : Encoding::kOther,
                                   definition});
    } else if (op == kMessage) {
      const auto channel = channels_.find(reader.read<std::uint16_t>());
      if (channel == channels_.end()) throw Damage(0, "a message of an unknown channel");
      (void)reader.read<std::uint32_t>();  // sequence number
      message->topic = channel->second;
      message->received = checked_time(reader.read<std::int64_t>());
      (void)reader.read<std::int64_t>();  // when it was published
      message->data = reader.skip(reader.remaining());
      return true;
    }
    return false;
  }

  /// The record at offset_; true if it is a message.
  bool read_from_file(Message* message) {
    constexpr std::uint64_t kPrefix = 9;
    const std::uint64_t start = offset_;
    if (start == file_.size()) {
      throw Damage(start, "the recording was not closed: its end may be missing");
    }
    file_.read(start, kPrefix, &record_);
    const std::uint8_t op = record_[0];
    const auto size = number_at<std::uint64_t>(record_.data() + 1, false);
    const std::uint64_t content = start + kPrefix;
    if (op == kChunk) {
      load_chunk(content, size);
      offset_ = content + size;
      return false;
    }
    file_.expect(content, size);
    offset_ = content + size;
    at_end_ = op == kDataEnd || op == kFooter;
    if (at_end_) expect_closed();
    if (op != kSchema && op != kChannel && op != kMessage) return false;
    file_.read(content, size, &record_);
    try {
      return read_record(op, record_, message);
    } catch (const Damage& damage) {
      throw Damage(content + damage.offset, damage.what());
    }
  }

  void load_chunk(std::uint64_t content, std::uint64_t size) {
    constexpr std::uint64_t kLongestHead = 128;  // 40 bytes and the name of the compression
    const std::uint64_t there = std::min({size, kLongestHead, file_.size() - content});
    file_.read(content, there, &record_);
    WireReader reader(record_);
    try {
      (void)reader.skip(16);  // first and last time
      const auto declared = reader.read<std::uint64_t>();
      const auto crc = reader.read<std::uint32_t>();
      const std::string compression(reader.text());
      const auto stored = reader.read<std::uint64_t>();
      if (stored != size - reader.position()) throw Damage(0, "the two sizes of the chunk differ");
      chunk_.load(&file_, content + reader.position(), stored, compression, declared, crc);
    } catch (const Damage& damage) {
      throw Damage(damage.offset < content ? content : damage.offset, damage.what());
    }
  }

  /// The last bytes repeat the magic at the beginning.
  void expect_closed() {
    const std::size_t size = std::strlen(kMcapMagic);
    file_.read(file_.size() - size, size, &record_);
    if (std::memcmp(record_.data(), kMcapMagic, size) != 0) {
      throw Damage(file_.size(), "the file does not end as MCAP files do; its messages are whole");
    }
  }

  FileBytes file_;
  std::uint64_t offset_ = std::strlen(kMcapMagic);
  bool at_end_ = false;
  Chunk chunk_;
  std::vector<std::uint8_t> record_;
  std::map<std::uint16_t, std::pair<std::string, std::string>> schemas_;  ///< type, definition
  std::map<std::uint16_t, std::size_t> channels_;                         ///< number -> topic
};

}  // namespace

std::unique_ptr<MessageStream> open_mcap(const std::filesystem::path& path) {
  return std::make_unique<Mcap>(path);
}

}  // namespace rio::bag
