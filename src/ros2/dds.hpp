// SPDX-License-Identifier: BSD-3-Clause
// What rio-ros2 needs of DDS: topics named and typed as ROS 2 does, messages in as the bytes on the
// wire, messages out as structs of messages.idl.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rio::ros2 {

/// A member of a DDS domain; deletes its readers and writers with itself.
class Participant {
 public:
  /// @throws std::runtime_error
  explicit Participant(dds_domainid_t domain);
  ~Participant() { dds_delete(participant_); }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds_entity_t entity() const { return participant_; }
  /// Sleeps until a reader has data, at most that long.
  void wait(dds_duration_t timeout);

 private:
  dds_entity_t participant_;
  dds_entity_t waitset_;
  friend class Reader;
};

/// Quality of service of ROS 2: "sensor data" is best effort, all else reliable; volatile.
enum class Qos { kSensorData, kReliable };

/// A subscription; `name` is that of ROS, "/imu/data".
class Reader {
 public:
  Reader(Participant* participant, const std::string& name, const dds_topic_descriptor_t& type,
         Qos qos, int depth);

  /// Replaces `message` by the oldest one, as CDR with its header; false if there is none.
  bool take(std::vector<std::uint8_t>* message);

 private:
  dds_entity_t reader_;
};

/// A publisher, reliable.
class AnyWriter {
 public:
  AnyWriter(const Participant& participant, const std::string& name,
            const dds_topic_descriptor_t& type, int depth);
  /// @throws std::runtime_error
  void write(const void* message);

 private:
  dds_entity_t writer_;
};

template <class Message>
class Writer : public AnyWriter {
 public:
  using AnyWriter::AnyWriter;
  void write(const Message& message) { AnyWriter::write(&message); }
};

}  // namespace rio::ros2
