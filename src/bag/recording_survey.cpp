// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "io/doppler_grid.hpp"
#include "recording_sources.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

void require_some(const Sources& sources, const Source& source) {
  const std::size_t absent = sources.accel == nullptr ? source.absent : 0;  // of halves: expected
  if (source.stamps.count > absent) return;
  const std::string error =
      source.first_error.empty() ? "" : "; the first one, " + source.first_error;
  sources.fail(
      "no readable message on {}{}{}{}", source.role.name, error,
      source.absent > 0 ? "; they say that they have no gyroscope or no accelerometer" : "",
      sources.damage().empty() ? "" : "; " + sources.damage());
}

/// Of the messages of a type.
Axes imu_axes(const RecordingRequest& request, const std::string& type) {
  return request.imu_axes.value_or(type == kPx4ImuType ? Axes::kFrd : Axes::kFlu);
}

/// The mounting that /tf_static tells.
std::optional<Pose> mounting(const Sources& sources, const Source& radar) {
  std::optional<Pose> T = sources.frames.pose(radar.frame, sources.imu->frame);
  if (T) {
    const Axes axes = imu_axes(sources.request(), sources.imu->type);
    T->translation = to_flu(axes, T->translation);
    T->rotation = Quaternion(flu_from(axes)) * T->rotation;
  }
  if (T && radar.clouds->map() != nullptr) {
    T->rotation = T->rotation * Quaternion(radar.clouds->map()->rotation().transpose());
  }
  return radar.frame == sources.imu->frame ? std::nullopt : T;
}

/// Pauses of the IMU and of all radars.
void tell_pauses(Sources* sources) {
  const Stamps& imu = sources->imu->stamps;
  std::vector<const Stamps*> radars;
  for (const Source* radar : sources->radars) radars.push_back(&radar->stamps);
  for (const Stamps::Pause& pause : imu.common_pauses(radars)) {
    sources->note(
        "clock set forward by {:.1f} s, or the recorder paused, {:.1f} s after the begin: the "
        "flight behind needs a recording of its own",
        to_seconds(pause.length), to_seconds(pause.end - pause.length - imu.first_received));
  }
}

/// Radars that end before the IMU.
void tell_ends(const io::RecordingOutline& outline, Sources* sources) {
  constexpr double kEarly = 1.0;  // [s] some scans
  for (std::size_t r = 0; r < sources->radars.size(); ++r) {
    // not of the difference, which may overflow
    const double ahead = to_seconds(outline.imu_end) - to_seconds(outline.scan_times[r].back());
    if (ahead < kEarly) continue;
    sources->note("{} ends {:.1f} s before {}", sources->radars[r]->role.name, ahead,
                  sources->imu->role.name);
  }
}

/// Of the scans of the outline.
std::optional<double> doppler_grid(const Sources& sources, const Surveyed& out, std::size_t r) {
  const Surveyed::Radar& radar = out.radars[r];
  const auto each_scan = [&](const auto& use) {
    const std::unique_ptr<MessageStream> stream = open_messages(sources.path());
    CloudReader clouds(sources.request().points);
    Message message;
    RadarScan scan;
    bool go_on = true;
    for (std::size_t i = 0; go_on && i < radar.place.size() && stream->next(&message);) {
      const Topic& topic = stream->topics()[message.topic];
      if (!radar.role.fits(topic)) continue;
      try {
        (void)clouds.read(topic, message, &scan.detections);
      } catch (const Damage&) {
        continue;
      }
      if (radar.place[i++]) go_on = use(scan);
    }
  };
  if (out.outline.scan_times[r].size() == radar.place.size()) {
    return sources.radars[r]->grid.step(each_scan);
  }
  io::DopplerGrid of_kept;
  each_scan([&of_kept](const RadarScan& scan) {
    of_kept.add(scan);
    return true;
  });
  return of_kept.step(each_scan);
}

std::optional<double> rate(Time begin, Time end, std::size_t count) {
  const double span = to_seconds(end) - to_seconds(begin);
  if (!(span > 0.0)) return std::nullopt;
  return static_cast<double>(count - 1) / span;
}

/// Sensor properties of a radar, and what its reading told.
void tell_radar(const Surveyed& surveyed, std::size_t r, io::RadarInfo* info, Sources* sources) {
  const Source& source = *sources->radars[r];
  const std::vector<Time>& times = surveyed.outline.scan_times[r];
  info->rate_hz = rate(times.front(), times.back(), times.size());
  for (const std::string& text : source.notes) {
    sources->note("{}{}", sources->radars.size() > 1 ? source.role.name + ": " : "", text);
  }
  info->T_BS = mounting(*sources, source);
  info->is_from_tree = info->T_BS.has_value();
  if (info->T_BS) {
    const Vector3d& p = info->T_BS->translation;
    const Quaternion& q = info->T_BS->rotation;
    sources->note(
        "{}: mounting of /tf_static: T_BS: {{translation: [{:.4f}, {:.4f}, {:.4f}], "
        "quaternion_wxyz: [{:.6f}, {:.6f}, {:.6f}, {:.6f}]}}",
        source.role.name, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  }
  info->doppler_resolution = doppler_grid(*sources, surveyed, r);
  if (info->doppler_resolution) {
    sources->note("the Doppler has steps of {:.4f} m/s", *info->doppler_resolution);
  }
  if (source.clouds->map() != nullptr) source.clouds->map()->name(info);
  if (source.clouds->points_left_out() > 0) {
    sources->note("{} points are not finite and are left out", source.clouds->points_left_out());
  }
}

/// Sensor properties, and notes on missing sensor files and dropped data.
void tell(Surveyed* surveyed, Sources* sources) {
  const RecordingRequest& request = sources->request();
  const Source& imu = *sources->imu;
  io::RecordingOutline& outline = surveyed->outline;
  outline.sensors.imu_info.rate_hz = rate(outline.imu_begin, outline.imu_end, outline.imu_samples);
  for (std::size_t r = 0; r < sources->radars.size(); ++r) {
    tell_radar(
        *surveyed, r,
        r == 0 ? &outline.sensors.radar_info : &outline.sensors.other_radars.emplace_back().info,
        sources);
  }
  if (!request.mounting_is_known && !outline.sensors.radar_info.T_BS) {
    const std::string why = sources->frames.why_not(sources->radars[0]->frame, imu.frame);
    sources->note(
        "no mounting in a recording{}: radar pose from the options, by default at the body origin",
        why.empty() ? "" : " (" + why + ")");
  }
  if (const Axes axes = imu_axes(request, imu.type); axes != Axes::kFlu) {
    sources->note("{}: axes {}{}, turned to forward, left, up", imu.role.name,
                  names_of(axes)[static_cast<std::size_t>(axes)],
                  request.imu_axes ? "" : ", those of PX4");
  }
  if (imu.denied > 0) {
    sources->note(
        "{}: {} messages have values and a covariance of -1, which says that they "
        "have none: the values are used",
        imu.role.name, imu.denied);
  }
  for (const Source* source : sources->used()) {
    const std::size_t absent = sources->accel == nullptr ? source->absent : 0;
    if (source->unreadable + absent == 0) continue;
    sources->note_left_out(source->role.name, source->unreadable + absent,
                           source->unreadable > 0
                               ? source->first_error
                               : "says that it has no gyroscope or accelerometer");
  }
  outline.sensors.notes = std::move(sources->notes);
}

}  // namespace

ImuMessage imu_message(const Topic& topic, const Message& message,
                       const RecordingRequest& request) {
  ImuMessage read = decode_imu_of(topic, message.data);
  const Axes axes = imu_axes(request, topic.type);
  read.sample.gyro_B = request.gyro_unit * to_flu(axes, read.sample.gyro_B);
  read.sample.accel_B = request.accel_unit * to_flu(axes, read.sample.accel_B);
  return read;
}

Header CloudReader::read(const Topic& topic, const Message& message,
                         std::vector<RadarDetection>* detections, std::vector<std::string>* notes) {
  detections->clear();
  const PointCloud cloud = decode_cloud_of(topic, message.data);
  if (cloud.size() == 0) return cloud.header;
  if (!map_ || map_->fields() != cloud.fields) {
    map_.emplace(cloud.fields, request_);
    if (notes != nullptr) notes->push_back("points, " + map_->text());
  }
  points_left_out_ += map_->convert(cloud, detections);
  map_->check_angles(cloud);
  return cloud.header;
}

Surveyed survey(const fs::path& path, const RecordingRequest& request) {
  Sources sources(path, request);
  if (request.imu_clock == Clock::kTrigger) {
    throw std::runtime_error("the clock \"trigger\" is for the radar alone");
  }
  sources.choose();
  for (const Source* source : sources.used()) require_some(sources, *source);
  Surveyed out;
  put_on_one_clock(&sources, &out);
  tell_pauses(&sources);
  tell_ends(out.outline, &sources);
  tell(&out, &sources);
  out.outline.sensors.damage = sources.damage();
  return out;
}

}  // namespace rio::bag
