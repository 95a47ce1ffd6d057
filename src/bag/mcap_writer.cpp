// SPDX-License-Identifier: BSD-3-Clause
#include "mcap_writer.hpp"

#include <algorithm>
#include <cstring>

#include "decompress.hpp"
#include "formats.hpp"

namespace rio::bag {

namespace {

using enum mcap::Op;

constexpr std::size_t kLongestChunk = 1 << 20;  // [bytes]

void append(ByteWriter* to, std::uint8_t op, const ByteWriter& content) {
  to->put(op).put(std::uint64_t{content.size()}).raw(content.bytes());
}

std::uint32_t crc_of(const std::string& bytes) {
  return crc32({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

}  // namespace

void McapWriter::Span::add(std::uint64_t time) {
  first = std::min(first, time);
  last = std::max(last, time);
}

McapWriter::McapWriter(const std::filesystem::path& path) : file_(path) {
  file_.write(kMcapMagic);
  position_ = std::strlen(kMcapMagic);
  write(kHeader, ByteWriter().block("ros2").block("rio"));
}

void McapWriter::write(std::uint8_t op, const ByteWriter& content) {
  ByteWriter record;
  append(&record, op, content);
  file_.write(record.bytes());
  position_ += record.size();
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& type,
                                      const std::string& definition) {
  const auto channel = static_cast<std::uint16_t>(messages_.size());
  const auto schema = static_cast<std::uint16_t>(channel + 1);  // 0 is none
  const ByteWriter a = ByteWriter().put(schema).block(type).block("ros2msg").block(definition);
  const ByteWriter b = ByteWriter().put(channel).put(schema).block(topic).block("cdr").block("");
  append(&head_, kSchema, a);
  append(&head_, kChannel, b);
  write(kSchema, a);
  write(kChannel, b);
  messages_[channel] = 0;
  return channel;
}

void McapWriter::add(std::uint16_t channel, std::uint64_t time, std::string_view message) {
  const auto sequence = static_cast<std::uint32_t>(messages_.at(channel)++);
  chunk_index_[channel].emplace_back(time, chunk_.size());
  append(&chunk_, kMessage,
         ByteWriter().put(channel).put(sequence).put(time).put(time).raw(message));
  chunk_span_.add(time);
  span_.add(time);
  if (chunk_.size() > kLongestChunk) flush();
}

void McapWriter::flush() {
  if (chunk_.size() == 0) return file_.flush();
  const std::uint64_t size = chunk_.size();
  const std::uint64_t begin = position_;
  write(kChunk, ByteWriter()
                    .put(chunk_span_.first)
                    .put(chunk_span_.last)
                    .put(size)
                    .put(crc_of(chunk_.bytes()))
                    .block("")
                    .put(size)
                    .raw(chunk_.bytes()));
  const std::uint64_t end = position_;
  ByteWriter places;
  for (const auto& [channel, index] : chunk_index_) {
    ByteWriter entries;
    for (const auto& [time, place] : index) entries.put(time).put(place);
    places.put(channel).put(position_);
    write(kMessageIndex, ByteWriter().put(channel).block(entries.bytes()));
  }
  append(&chunk_records_, kChunkIndex,
         ByteWriter()
             .put(chunk_span_.first)
             .put(chunk_span_.last)
             .put(begin)
             .put(end - begin)
             .block(places.bytes())
             .put(position_ - end)
             .block("")
             .put(size)
             .put(size));
  ++chunks_;
  chunk_.clear();
  chunk_index_.clear();
  chunk_span_ = {};
  file_.flush();
}

void McapWriter::close() {
  flush();
  write(kDataEnd, ByteWriter().put(std::uint32_t{0}));  // no checksum of the whole file
  const std::uint64_t summary = position_;
  std::uint64_t total = 0;
  ByteWriter counts;
  for (const auto& [channel, count] : messages_) {
    counts.put(channel).put(count);
    total += count;
  }
  file_.write(head_.bytes());
  position_ += head_.size();
  write(kStatistics, ByteWriter()
                         .put(total)
                         .put(static_cast<std::uint16_t>(messages_.size()))  // schemas
                         .put(static_cast<std::uint32_t>(messages_.size()))
                         .put(std::uint32_t{0})  // attachments
                         .put(std::uint32_t{0})  // metadata
                         .put(chunks_)
                         .put(total > 0 ? span_.first : 0)
                         .put(span_.last)
                         .block(counts.bytes()));
  file_.write(chunk_records_.bytes());
  position_ += chunk_records_.size();
  write(kFooter, ByteWriter().put(summary).put(std::uint64_t{0}).put(std::uint32_t{0}));
  file_.write(kMcapMagic);
  file_.close();
}

}  // namespace rio::bag
