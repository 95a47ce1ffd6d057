// SPDX-License-Identifier: BSD-3-Clause
// Small recordings in each format, for tests of the readers; shares no code with them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#ifdef RIO_HAS_BZ2
#include <bzlib.h>
#endif
#ifdef RIO_HAS_LZ4
#include <lz4frame.h>
#endif
#ifdef RIO_HAS_SQLITE3
#include <sqlite3.h>
#endif
#ifdef RIO_HAS_ZSTD
#include <zstd.h>
#endif

#include "bag/ros_message.hpp"

namespace rio::test {

struct Written {
  std::string topic;
  std::string type;
  Time received{0};
  std::string data;
};

/// The formats this build can read, as "ros1-bz2".
inline std::vector<std::string> formats() {
  std::vector<std::string> all = {"ros1-none", "mcap-none"};
#ifdef RIO_HAS_BZ2
  all.push_back("ros1-bz2");
#endif
#ifdef RIO_HAS_LZ4
  all.push_back("ros1-lz4");
  all.push_back("mcap-lz4");
#endif
#ifdef RIO_HAS_ZSTD
  all.push_back("mcap-zstd");
#endif
#ifdef RIO_HAS_SQLITE3
  all.push_back("db3");
#endif
  return all;
}

/// Names of the tests of a format.
inline std::string format_name(const testing::TestParamInfo<std::string>& format) {
  std::string name = format.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// "sensor_msgs/msg/Imu" of "sensor_msgs/Imu".
inline std::string ros2_type(const std::string& type) {
  const std::size_t slash = type.find('/');
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

/// How messages are serialised in a format.
inline Wire::Kind wire_of(const std::string& format) {
  return format.starts_with("ros1") ? Wire::kRos1 : Wire::kCdr;
}

inline std::string compressed([[maybe_unused]] const std::string& method,
                              const std::string& plain) {
  std::string out(2 * plain.size() + 1024, '\0');
#ifdef RIO_HAS_BZ2
  if (method == "bz2") {
    auto size = static_cast<unsigned>(out.size());
    BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(plain.data()),
                             static_cast<unsigned>(plain.size()), 9, 0, 0);
    return out.substr(0, size);
  }
#endif
#ifdef RIO_HAS_LZ4
  if (method == "lz4") {
    return out.substr(
        0, LZ4F_compressFrame(out.data(), out.size(), plain.data(), plain.size(), nullptr));
  }
#endif
#ifdef RIO_HAS_ZSTD
  if (method == "zstd") {
    return out.substr(0, ZSTD_compress(out.data(), out.size(), plain.data(), plain.size(), 3));
  }
#endif
  return plain;
}

/// Topic -> its number, in the order of their first message.
using Numbers = std::map<std::string, std::uint16_t>;
inline std::pair<Numbers::iterator, bool> number_of(const Written& message, Numbers* numbers) {
  return numbers->emplace(message.topic, static_cast<std::uint16_t>(numbers->size()));
}

template <class T>
std::string raw(T value) {
  return Wire(Wire::kRos1).put(value).bytes;
}
inline std::string block(const std::string& bytes) {
  return raw(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

/// A ROS 1 bag 2.0 of chunks of `per_chunk` messages.
inline std::string ros1_bag(const std::vector<Written>& messages, const std::string& compression,
                            std::size_t per_chunk) {
  const auto field = [](const std::string& name, const std::string& value) {
    return block(name + "=" + value);
  };
  const auto record = [](const std::string& header, const std::string& data) {
    return block(header) + block(data);
  };
  Numbers numbers;
  std::string connections;
  std::string body;
  for (std::size_t i = 0; i < messages.size();) {
    std::string chunk;
    for (std::size_t end = std::min(messages.size(), i + per_chunk); i < end; ++i) {
      const Written& m = messages[i];
      const auto [topic, is_new] = number_of(m, &numbers);
      const std::string number = field("conn", raw(std::uint32_t{topic->second}));
      if (is_new) {
        const std::string connection =
            record(field("op", "\x07") + number + field("topic", m.topic),
                   field("topic", m.topic) + field("type", m.type) + field("md5sum", "*") +
                       field("message_definition", "# text\nHeader header\nfloat64 x\n"));
        connections += connection;
        chunk += connection;
      }
      const auto ns = static_cast<std::uint64_t>(m.received.count());
      const std::string time = raw(static_cast<std::uint32_t>(ns / 1'000'000'000)) +
                               raw(static_cast<std::uint32_t>(ns % 1'000'000'000));
      chunk += record(field("op", "\x02") + number + field("time", time), m.data);
    }
    body += record(field("op", "\x05") + field("compression", compression) +
                       field("size", raw(static_cast<std::uint32_t>(chunk.size()))),
                   compressed(compression, chunk));
    body += record(field("op", "\x04") + field("ver", raw(std::uint32_t{1})), "index");
  }
  const std::string magic = "#ROSBAG V2.0\n";
  const auto head = [&](std::uint64_t index) {
    return record(field("op", "\x03") + field("index_pos", raw(index)), std::string(64, ' '));
  };
  const std::uint64_t index = magic.size() + head(0).size() + body.size();
  return magic + head(index) + body + connections;
}

inline std::string mcap(const std::vector<Written>& messages, const std::string& compression,
                        std::size_t per_chunk, const std::string& encoding = "cdr") {
  const auto record = [](char op, const std::string& content) {
    return op + raw(static_cast<std::uint64_t>(content.size())) + content;
  };
  const auto crc = [](const std::string& bytes) {
    std::uint32_t value = ~0U;
    for (const char c : bytes) {
      value ^= static_cast<std::uint8_t>(c);
      for (int i = 0; i < 8; ++i) value = value & 1U ? (value >> 1U) ^ 0xEDB88320U : value >> 1U;
    }
    return ~value;
  };
  Numbers numbers;
  std::string body = record(1, block("ros2") + block("test"));
  for (std::size_t i = 0; i < messages.size();) {
    std::string chunk;
    for (std::size_t end = std::min(messages.size(), i + per_chunk); i < end; ++i) {
      const Written& m = messages[i];
      const auto [topic, is_new] = number_of(m, &numbers);
      const std::uint16_t id = topic->second;
      if (is_new) {
        const std::string type = encoding == "cdr" ? ros2_type(m.type) : m.type;
        chunk += record(3, raw(static_cast<std::uint16_t>(id + 1)) + block(type) +
                               block("ros2msg") + block("std_msgs/Header header\n"));
        chunk += record(4, raw(id) + raw(static_cast<std::uint16_t>(id + 1)) + block(m.topic) +
                               block(encoding) + block(""));
      }
      const auto time = static_cast<std::uint64_t>(m.received.count());
      chunk += record(5, raw(id) + raw(std::uint32_t{1}) + raw(time) + raw(time) + m.data);
    }
    const std::string stored = compressed(compression, chunk);
    body += record(6, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) +
                          raw(static_cast<std::uint64_t>(chunk.size())) + raw(crc(chunk)) +
                          block(compression == "none" ? "" : compression) +
                          raw(static_cast<std::uint64_t>(stored.size())) + stored);
    body += record(7, "index");
  }
  const std::string magic = "\x89MCAP0\r\n";
  return magic + body + record(15, raw(std::uint32_t{0})) + record(2, std::string(20, '\0')) +
         magic;
}

inline void db3([[maybe_unused]] const std::filesystem::path& path,
                [[maybe_unused]] const std::vector<Written>& messages) {
#ifdef RIO_HAS_SQLITE3
  sqlite3* db = nullptr;
  sqlite3_open(path.c_str(), &db);
  sqlite3_exec(db,
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
               " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
               " timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
               "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN",
               nullptr, nullptr, nullptr);
  Numbers numbers;
  for (const Written& m : messages) {
    const auto [topic, is_new] = number_of(m, &numbers);
    const std::string id = std::to_string(topic->second + 1);
    if (is_new) {
      const std::string sql = "INSERT INTO topics VALUES(" + id + ",'" + m.topic + "','" +
                              ros2_type(m.type) + "','cdr','')";
      sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr);
    }
    sqlite3_stmt* row = nullptr;
    const std::string sql = "INSERT INTO messages(topic_id, timestamp, data) VALUES(" + id + "," +
                            std::to_string(m.received.count()) + ",?)";
    sqlite3_prepare_v2(db, sql.c_str(), -1, &row, nullptr);
    sqlite3_bind_blob(row, 1, m.data.data(), static_cast<int>(m.data.size()), SQLITE_STATIC);
    sqlite3_step(row);
    sqlite3_finalize(row);
  }
  sqlite3_exec(db, "COMMIT", nullptr, nullptr, nullptr);
  sqlite3_close(db);
#endif
}

/// Writes the file in one of formats().
inline void write_bag(const std::filesystem::path& path, const std::string& format,
                      const std::vector<Written>& messages, std::size_t per_chunk = 20) {
  if (format == "db3") return db3(path, messages);
  const std::string compression = format.substr(5);
  std::ofstream(path, std::ios::binary)
      << (format.starts_with("ros1") ? ros1_bag(messages, compression, per_chunk)
                                     : mcap(messages, compression, per_chunk));
}

inline constexpr Time kBegin(1'600'000'000'123'456'789);  ///< of at_rest()
inline constexpr Time kDelay(250'000'000);                ///< of its messages

/// Some seconds at rest: an IMU at 100 Hz and a radar of TI's driver at 10 Hz, stamped by headers.
inline std::vector<Written> at_rest(Wire::Kind kind, int scans) {
  std::vector<Written> messages;
  for (int i = 0; i < 10 * scans; ++i) {
    const Time stamp = kBegin + i * Time(10'000'000);
    const Time received = stamp + kDelay;
    const ImuSample sample{stamp, {0.01, -0.02, 0.001 * i}, {0.1, 0.2, 9.81}};
    messages.push_back({"/imu", "sensor_msgs/Imu", received, imu_message(kind, sample)});
    if (i % 10 != 9) continue;
    const Points points = {{1.5, 2.5, -0.5, 12.0, 0.25}, {3.0, -1.0, 0.5, 20.0, 0.1 * i}};
    messages.push_back({"/radar", "sensor_msgs/PointCloud2", received + Time(1000),
                        cloud_message(kind, stamp, ti_fields(), points, 32)});
  }
  return messages;
}

}  // namespace rio::test
