// SPDX-License-Identifier: BSD-3-Clause
#include "recording_sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <stdexcept>

namespace rio::bag {

namespace {

std::string topic_list(const Summary& summary) {
  std::string text;
  for (const TopicSummary& s : summary.topics) {
    text += fmt::format("\n  {} {} ({} messages{})", s.topic.name, s.topic.type, s.messages,
                        s.topic.encoding == Encoding::kOther ? ", neither ROS 1 nor CDR" : "");
  }
  return text.empty() ? "\n  none" : text;
}

/// What is looked for.
struct Asked {
  const char* role;
  const char* type;
  std::string RecordingRequest::*topic;
};
constexpr Asked kAsked[] = {{"imu", kImuType, &RecordingRequest::imu_topic},
                            {"radar", kCloudType, &RecordingRequest::radar_topic},
                            {"trigger", kHeaderType, &RecordingRequest::trigger_topic},
                            {"pressure", kPressureType, &RecordingRequest::pressure_topic},
                            {"truth", kPoseType, &RecordingRequest::truth_topic},
                            {"positions", kPointType, &RecordingRequest::truth_topic}};

/// At least one, which may be empty.
std::vector<std::string> names_in(const std::string& list, char separator = ',') {
  std::vector<std::string> names;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = list.find(separator, begin);
    names.push_back(list.substr(begin, end - begin));
  }
  return names;
}

}  // namespace

Sources::Sources(const std::filesystem::path& path, const RecordingRequest& request)
    : path_(path), request_(request), stream_(open_messages(path)) {
  for (const auto& [role, type, topic] : kAsked) {
    const bool is_trigger = topic == &RecordingRequest::trigger_topic;
    if (is_trigger && request.radar_clock != Clock::kTrigger) continue;
    const bool asked = type == kPointType ? request.positions : request.truth;
    if (topic == &RecordingRequest::truth_topic && !asked) continue;
    for (const std::string& each : names_in(request.*topic)) {
      for (const std::string& name : names_in(each, '|')) wanted_.push_back({role, type, name});
    }
  }
  summary_ = summarise(stream_.get(), [this](const Message& message) { use(message); });
}

void Sources::choose() {
  for (const auto& [role, type, topic] : kAsked) {
    request_.*topic = present(role, request_.*topic);
  }
  choose_imu();
  choose_radars();
  if (request_.radar_clock == Clock::kTrigger) {
    trigger = only(found("trigger", request_.trigger_topic));
  }
  baro = choose_optional("pressure", request_.pressure_topic);
  if (request_.truth) truth = choose_optional(truth_role(), request_.truth_topic);
  for (const Source* radar : radars) {
    if (radar->failed) std::rethrow_exception(radar->failed);
  }
}

Source* Sources::find(const std::string& role, const std::string& name) {
  const auto found = std::find_if(sources_.begin(), sources_.end(), [&](const Source& source) {
    return source.role.role == role && source.role.name == name;
  });
  return found == sources_.end() ? nullptr : &*found;
}

/// Of each name with alternatives the first with messages; the first of all if none has.
std::string Sources::present(const std::string& role, const std::string& names) {
  std::string list;
  for (const std::string& each : names_in(names)) {
    const std::vector<std::string> all = names_in(each, '|');
    const auto there = std::find_if(all.begin(), all.end(), [&](const std::string& name) {
      return name.empty() || find(role, name) != nullptr;
    });
    list += (list.empty() ? "" : ",") + (there == all.end() ? all.front() : *there);
  }
  return list;
}

/// For each possible source; the choice is made at the end.
void Sources::use(const Message& message) {
  while (uses_.size() < stream_->topics().size()) {
    const Topic& topic = stream_->topics()[uses_.size()];
    uses_.emplace_back();
    for (const Role& role : wanted_) {
      // --imu may name one half of an IMU
      const bool half = role.type == kImuType && Role{"", kImuType, ""}.fits(topic);
      if (!role.fits(topic) && !half) continue;
      Source* source = find(role.role, topic.name);
      if (source == nullptr) {
        source = &sources_.emplace_back(Source{{role.role, role.type, topic.name}});
        source->type = topic.type;
        source->clouds.emplace(request_.points);
      }
      if (std::count(uses_.back().begin(), uses_.back().end(), source) == 0) {
        uses_.back().push_back(source);
      }
    }
  }
  const Topic& topic = stream_->topics()[message.topic];
  if (is_moving_transforms(topic)) frames.pass_by_moving();
  if (is_transforms(topic) && topic.encoding != Encoding::kOther) {
    try {
      frames.add(decode_transforms(topic.encoding, message.data));
    } catch (const Damage& damage) {
      frames.refuse(damage.what());
    }
  }
  for (Source* source : uses_[message.topic]) {
    if (!source->failed) decode(source, topic, message);
  }
}

void Sources::decode(Source* source, const Topic& topic, const Message& message) {
  const std::string& type = source->role.type;
  try {
    Header header;
    if (type == kImuType) {
      const ImuMessage read = imu_message(topic, message, request_);
      header = read.header;
      source->without_gyro += read.gyro ? 0 : 1;
      source->without_accel += read.accel ? 0 : 1;
      source->absent += read.absent ? 1 : 0;
      source->denied += read.denied ? 1 : 0;
    } else if (type == kPressureType) {
      const double pressure = decode_pressure(topic.encoding, message.data, &header);
      source->baro.push_back({Time(0), pressure});
    } else if (type == kPoseType) {
      source->truth.push_back(decode_truth(topic, message.data, &header, &source->has_velocity));
    } else if (type == kPointType) {
      source->truth.push_back(decode_position(topic, message.data, &header, &source->first_fix));
      source->has_velocity = false;
    } else if (type == kCloudType) {
      header = source->clouds->read(topic, message, &scan_.detections, &source->notes);
      source->grid.add(scan_);
    } else {
      header = decode_header(topic.encoding, message.data);
    }
    if (source->stamps.count == 0) source->frame = header.frame_id;
    source->stamps.add(header, message.received, type != kImuType);
  } catch (const Damage& damage) {
    if (source->unreadable++ == 0) {
      source->first_error = fmt::format("byte {}: {}", damage.offset, damage.what());
    }
  } catch (const std::runtime_error&) {
    source->failed = std::current_exception();
  }
}

std::vector<Source*> Sources::with_messages(const std::string& role) {
  std::vector<Source*> out;
  for (Source& source : sources_) {
    const bool any = source.stamps.count + source.unreadable > 0 || source.failed;
    if (source.role.role == role && any) out.push_back(&source);
  }
  return out;
}

std::vector<Source*> Sources::found(const std::string& role, const std::string& names) {
  std::vector<Source*> out;
  for (const std::string& name : names_in(names)) {
    const std::size_t before = out.size();
    std::string wrong_type;  // of the requested topic
    for (const TopicSummary& s : summary_.topics) {
      if (s.topic.name == name) wrong_type = s.topic.type;
    }
    for (Source* source : with_messages(role)) {
      if (name.empty() || source->role.name == name) out.push_back(source);
    }
    if (out.size() > before) continue;
    const std::string type =
        std::find_if(std::begin(kAsked), std::end(kAsked), [&](const Asked& asked) {
          return asked.role == role;
        })->type;
    if (!wrong_type.empty()) {
      fail("topic {} is of type {}; read is {}, of ROS 1 or CDR", name, wrong_type, type);
    }
    fail("no topic {}; there are{}{}", name.empty() ? "of type " + type : name,
         topic_list(summary_), summary_.damage.empty() ? "" : "\n" + summary_.damage);
  }
  return out;
}

void Sources::fail_ambiguous(const Source& one, const std::string& why) const {
  const std::string topics = topic_list(summary_);
  const bool framed = topics.find('@') != std::string::npos;
  fail("several topics of type {}; choose with --{}{}{}:{}", one.role.type, one.role.role,
       framed ? " (TOPIC@FRAME: those of its messages with that frame_id)" : "", why, topics);
}

Source* Sources::only(const std::vector<Source*>& sources) const {
  if (sources.size() > 1) fail_ambiguous(*sources[0]);
  return sources[0];
}

Source* Sources::choose_optional(const std::string& role, const std::string& name) {
  if (!name.empty()) return only(found(role, name));
  std::vector<Source*> sources = with_messages(role);
  for (const Source* source : sources) {
    if (source->stamps.count > 0) continue;
    note_left_out(source->role.name, source->unreadable, source->first_error);
  }
  std::erase_if(sources, [](const Source* source) { return source->stamps.count == 0; });
  if (sources.size() > 1) {
    std::string names;
    for (const Source* source : sources) names += " " + source->role.name;
    note("several topics may be the {}: none is used; --{} chooses one:{}", role, role, names);
  }
  return sources.size() == 1 ? sources[0] : nullptr;
}

/// The only IMU; or gyroscope and accelerometer, if they are on two topics.
void Sources::choose_imu() {
  using IsHalf = bool (Source::*)() const;
  const auto halves = [](const std::vector<Source*>& all, IsHalf is_half) {
    std::vector<Source*> out;
    std::copy_if(all.begin(), all.end(), std::back_inserter(out), std::mem_fn(is_half));
    return out;
  };
  std::vector<Source*> sources = found("imu", request_.imu_topic);
  std::vector<Source*> gyros = halves(sources, &Source::only_gyro);
  std::vector<Source*> accels = halves(sources, &Source::only_accel);
  if (gyros.size() + accels.size() < sources.size()) {
    if (request_.imu_topic.empty()) {
      std::erase_if(sources, [](const Source* s) { return s->only_gyro() || s->only_accel(); });
    }
    imu = only(sources);
    return;
  }
  // one of them may be named alone
  if (gyros.empty()) gyros = halves(found("imu", ""), &Source::only_gyro);
  if (accels.empty()) accels = halves(found("imu", ""), &Source::only_accel);
  if (gyros.empty() || accels.empty()) {
    fail("{} has no {}, and no other topic has it", sources[0]->role.name,
         gyros.empty() ? "gyroscope" : "accelerometer");
  }
  imu = only(gyros);
  accel = only(accels);
  note("the IMU is on two topics: gyroscope {}, accelerometer {} at its stamps", imu->role.name,
       accel->role.name);
}

/// The requested ones, or the only one, or all of which /tf_static knows the mounting.
void Sources::choose_radars() {
  radars = found("radar", request_.radar_topic);
  if (!request_.radar_topic.empty()) return check_number_of_radars();
  const auto failed = [](const Source* s) { return s->failed != nullptr; };
  if (radars.size() > 1 && !std::all_of(radars.begin(), radars.end(), failed)) {
    std::erase_if(radars, failed);  // clouds without Doppler
  }
  if (radars.size() == 1) return;
  std::vector<std::string> known;
  for (const Source* radar : radars) {
    const bool same = std::count(known.begin(), known.end(), radar->frame) > 0;
    if (same || !frames.pose(radar->frame, imu->frame)) {
      const std::string why =
          same ? "another one has the same frame" : frames.why_not(radar->frame, imu->frame);
      fail_ambiguous(*radar,
                     fmt::format(" (all at once would need the mounting of each: {}: {}); if "
                                 "--sensors has them: --radar TOPIC,TOPIC in its order",
                                 radar->role.name, why.empty() ? "there is no /tf_static" : why));
    }
    known.push_back(radar->frame);
  }
  std::sort(radars.begin(), radars.end(),
            [](const Source* a, const Source* b) { return a->role.name < b->role.name; });
  check_number_of_radars();
}

void Sources::check_number_of_radars() const {
  if (radars.size() <= 1 + Options::kMaxOtherRadars) return;
  fail("{} radars, at most {} are used; choose with --radar", radars.size(),
       1 + Options::kMaxOtherRadars);
}

std::vector<Source*> Sources::used() const {
  std::vector<Source*> all = {imu};
  for (Source* source : {accel, trigger, baro, truth}) {
    if (source != nullptr) all.push_back(source);
  }
  all.insert(all.begin() + 1, radars.begin(), radars.end());
  return all;
}

}  // namespace rio::bag
