// SPDX-License-Identifier: BSD-3-Clause
#include "ros2/dds.hpp"

#include <dds/ddsi/ddsi_serdata.h>

#include <memory>
#include <stdexcept>

namespace rio::ros2 {

namespace {

struct FreeQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosHandle = std::unique_ptr<dds_qos_t, FreeQos>;

/// An entity, or what is wrong instead.
dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity < 0) throw std::runtime_error(what + ": " + dds_strretcode(-entity));
  return entity;
}

QosHandle qos_of(Qos qos, int depth) {
  QosHandle handle(dds_create_qos());
  dds_qset_durability(handle.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(handle.get(), DDS_HISTORY_KEEP_LAST, depth);
  if (qos == Qos::kReliable) {
    dds_qset_reliability(handle.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  } else {
    dds_qset_reliability(handle.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  }
  return handle;
}

dds_entity_t topic_of(const Participant& participant, const std::string& name,
                      const dds_topic_descriptor_t& type) {
  if (name.size() < 2 || name[0] != '/') {
    throw std::runtime_error("topic \"" + name + "\": a name as /imu/data is expected");
  }
  return checked(
      dds_create_topic(participant.entity(), &type, ("rt" + name).c_str(), nullptr, nullptr),
      "topic " + name);
}

}  // namespace

Participant::Participant(dds_domainid_t domain)
    : participant_(checked(dds_create_participant(domain, nullptr, nullptr),
                           "DDS domain " + std::to_string(domain))),
      waitset_(checked(dds_create_waitset(participant_), "DDS waitset")) {}

void Participant::wait(dds_duration_t timeout) {
  (void)dds_waitset_wait(waitset_, nullptr, 0, timeout);
}

Reader::Reader(Participant* participant, const std::string& name,
               const dds_topic_descriptor_t& type, Qos qos, int depth)
    : reader_(checked(dds_create_reader(participant->entity(), topic_of(*participant, name, type),
                                        qos_of(qos, depth).get(), nullptr),
                      "subscription to " + name)) {
  const dds_entity_t data = checked(dds_create_readcondition(reader_, DDS_ANY_STATE), name);
  checked(dds_waitset_attach(participant->waitset_, data, 0), name);
}

bool Reader::take(std::vector<std::uint8_t>* message) {
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info;
  while (dds_takecdr(reader_, &data, 1, &info, DDS_ANY_STATE) > 0) {
    message->resize(ddsi_serdata_size(data));
    if (info.valid_data) ddsi_serdata_to_ser(data, 0, message->size(), message->data());
    ddsi_serdata_unref(data);
    if (info.valid_data) return true;  // else a publisher has gone
  }
  return false;
}

AnyWriter::AnyWriter(const Participant& participant, const std::string& name,
                     const dds_topic_descriptor_t& type, int depth)
    : writer_(checked(dds_create_writer(participant.entity(), topic_of(participant, name, type),
                                        qos_of(Qos::kReliable, depth).get(), nullptr),
                      "publisher of " + name)) {}

void AnyWriter::write(const void* message) {
  const dds_return_t result = dds_write(writer_, message);
  // a reliable reader that does not keep up, or died a moment ago, loses this message
  if (result < 0 && result != DDS_RETCODE_TIMEOUT) {
    throw std::runtime_error(std::string("DDS: not written: ") + dds_strretcode(-result));
  }
}

}  // namespace rio::ros2
