// SPDX-License-Identifier: BSD-3-Clause
#include "recording_sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace rio::bag {

namespace {

std::string topic_list(const Summary& summary) {
  std::string text;
  for (const TopicSummary& s : summary.topics) {
    text += fmt::format("\n  {} {} ({} messages)", s.topic.name, s.topic.type, s.messages);
  }
  return text.empty() ? "\n  none" : text;
}

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

std::string left_out_text(const std::string& topic, std::size_t count, const std::string& first) {
  return fmt::format("{}: {} messages cannot be read and are left out; the first one, {}", topic,
                     count, first);
}

Sources::Sources(const std::filesystem::path& path, const RecordingRequest& request)
    : path_(path), request_(request), stream_(open_messages(path)) {
  want("imu", kImuType, request.imu_topic);
  want("radar", kCloudType, request.radar_topic);
  if (request.radar_clock == Clock::kTrigger) want("trigger", kHeaderType, request.trigger_topic);
  want("pressure", kPressureType, request.pressure_topic);
  if (request.truth) want("truth", kPoseType, request.truth_topic);
  summary_ = summarise(stream_.get(), [this](const Message& message) { use(message); });
}

void Sources::choose() {
  request_.imu_topic = present("imu", request_.imu_topic);
  request_.radar_topic = present("radar", request_.radar_topic);
  request_.trigger_topic = present("trigger", request_.trigger_topic);
  request_.pressure_topic = present("pressure", request_.pressure_topic);
  request_.truth_topic = present("truth", request_.truth_topic);
  choose_imu();
  choose_radars();
  if (request_.radar_clock == Clock::kTrigger) {
    trigger = only(found("trigger", request_.trigger_topic));
  }
  baro = choose_optional("pressure", request_.pressure_topic);
  if (request_.truth) truth = choose_optional("truth", request_.truth_topic);
  for (const Source* radar : radars) {
    if (radar->failed) std::rethrow_exception(radar->failed);
  }
}

void Sources::want(const char* role, const char* type, const std::string& names) {
  for (const std::string& each : names_in(names)) {
    for (const std::string& name : names_in(each, '|')) wanted_.push_back({role, type, name});
  }
}

/// Of each name with alternatives the first with messages; the first of all if none has.
std::string Sources::present(const std::string& role, const std::string& names) const {
  std::string list;
  for (const std::string& each : names_in(names)) {
    const std::vector<std::string> all = names_in(each, '|');
    const auto there = std::find_if(all.begin(), all.end(), [&](const std::string& name) {
      return name.empty() || std::any_of(sources_.begin(), sources_.end(), [&](const Source& s) {
               return s.role.role == role && s.role.name == name;
             });
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
      const auto known = std::find_if(sources_.begin(), sources_.end(), [&](const Source& s) {
        return s.role.role == std::string(role.role) && s.role.name == topic.name;
      });
      Source* source = known == sources_.end() ? nullptr : &*known;
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
  if (is_transforms(topic) && topic.encoding != Encoding::kOther) {
    try {
      frames.add(decode_transforms(topic.encoding, message.data));
    } catch (const Damage&) {  // as if there were none
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
    } else if (type == kCloudType) {
      source->clouds->read(topic, message, &header, &scan_.detections, &source->notes);
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

std::vector<Source*> Sources::found(const std::string& role, const std::string& names) {
  std::vector<Source*> out;
  for (const std::string& name : names_in(names)) {
    const std::size_t before = out.size();
    std::string wrong_type;  // of the requested topic
    for (const TopicSummary& s : summary_.topics) {
      if (s.topic.name == name) wrong_type = s.topic.type;
    }
    for (Source& source : sources_) {
      if (source.role.role != role || (!name.empty() && source.role.name != name)) continue;
      if (source.stamps.count + source.unreadable > 0 || source.failed) out.push_back(&source);
    }
    if (out.size() > before) continue;
    const auto asked =
        std::find_if(wanted_.begin(), wanted_.end(), [&](const Role& r) { return r.role == role; });
    if (!wrong_type.empty()) {
      throw std::runtime_error(fmt::format("{}: topic {} is of type {}; read is {}", path_.string(),
                                           name, wrong_type, asked->type));
    }
    throw std::runtime_error(fmt::format("{}: no topic {}; there are{}{}", path_.string(),
                                         name.empty() ? "of type " + asked->type : name,
                                         topic_list(summary_),
                                         summary_.damage.empty() ? "" : "\n" + summary_.damage));
  }
  return out;
}

void Sources::fail_ambiguous(const Source& one) const {
  throw std::runtime_error(fmt::format("{}: several topics of type {}; choose with --{}:{}",
                                       path_.string(), one.role.type, one.role.role,
                                       topic_list(summary_)));
}

Source* Sources::only(const std::vector<Source*>& sources) const {
  if (sources.size() > 1) fail_ambiguous(*sources[0]);
  return sources[0];
}

Source* Sources::choose_optional(const std::string& role, const std::string& name) {
  if (!name.empty()) return only(found(role, name));
  Source* one = nullptr;
  std::size_t count = 0;
  for (Source& source : sources_) {
    if (source.role.role != role) continue;
    if (source.stamps.count == 0) {
      notes.push_back(left_out_text(source.role.name, source.unreadable, source.first_error));
      continue;
    }
    one = &source;
    ++count;
  }
  if (count > 1)
    notes.push_back(fmt::format("several topics may be the {}: none is used; --{}", role, role));
  return count == 1 ? one : nullptr;
}

/// The only IMU; or gyroscope and accelerometer, if they are on two topics.
void Sources::choose_imu() {
  std::vector<Source*> whole = found("imu", request_.imu_topic);
  std::vector<Source*> all = found("imu", "");
  std::vector<Source*> gyros;
  std::vector<Source*> accels;
  const auto sort_out = [&](const std::vector<Source*>& from) {
    for (Source* source : from) {
      if (source->only_gyro()) gyros.push_back(source);
      if (source->only_accel()) accels.push_back(source);
    }
  };
  const auto is_half = [](const Source* s) { return s->only_gyro() || s->only_accel(); };
  sort_out(whole);
  if (!std::all_of(whole.begin(), whole.end(), is_half)) {
    if (request_.imu_topic.empty()) std::erase_if(whole, is_half);
    imu = only(whole);
    return;
  }
  if (gyros.empty() || accels.empty()) {  // the other half
    gyros.clear();
    accels.clear();
    sort_out(all);
    const bool of_gyro = whole[0]->only_gyro();
    if (whole.size() == 1) (of_gyro ? gyros : accels) = whole;
  }
  if (gyros.empty() || accels.empty()) {
    throw std::runtime_error(fmt::format("{}: {} has no {}, and no other topic has it",
                                         path_.string(), whole[0]->role.name,
                                         gyros.empty() ? "gyroscope" : "accelerometer"));
  }
  imu = only(gyros);
  accel = only(accels);
  notes.push_back(
      fmt::format("the IMU is on two topics: gyroscope {}, accelerometer {} at its stamps",
                  imu->role.name, accel->role.name));
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
    if (same || !frames.pose(radar->frame, imu->frame)) fail_ambiguous(*radar);
    known.push_back(radar->frame);
  }
  std::sort(radars.begin(), radars.end(),
            [](const Source* a, const Source* b) { return a->role.name < b->role.name; });
  check_number_of_radars();
}

void Sources::check_number_of_radars() const {
  if (radars.size() <= 1 + Options::kMaxOtherRadars) return;
  throw std::runtime_error(fmt::format("{}: {} radars, at most {} are used; choose with --radar",
                                       path_.string(), radars.size(),
                                       1 + Options::kMaxOtherRadars));
}

std::vector<Source*> Sources::used() const {
  std::vector<Source*> all = {imu};
  for (Source* source : {accel, trigger, baro, truth}) {
    if (source != nullptr) all.push_back(source);
  }
  all.insert(all.begin() + 1, radars.begin(), radars.end());
  return all;
}

ImuMessage imu_message(const Topic& topic, const Message& message,
                       const RecordingRequest& request) {
  ImuMessage read = decode_imu_of(topic, message.data);
  read.sample.gyro_B = request.gyro_unit * to_flu(request.imu_axes, read.sample.gyro_B);
  read.sample.accel_B = request.accel_unit * to_flu(request.imu_axes, read.sample.accel_B);
  return read;
}

void CloudReader::read(const Topic& topic, const Message& message, Header* header,
                       std::vector<RadarDetection>* detections, std::vector<std::string>* notes) {
  detections->clear();
  const PointCloud cloud = decode_cloud_of(topic, message.data);
  *header = cloud.header;
  if (cloud.size() == 0) return;
  if (!map_ || map_->fields() != cloud.fields) {
    map_.emplace(cloud.fields, request_);
    if (notes != nullptr) notes->push_back("points, " + map_->text());
  }
  points_left_out_ += map_->convert(cloud, detections);
  map_->check_angles(cloud);
}

}  // namespace rio::bag
