// SPDX-License-Identifier: BSD-3-Clause
// `rio info`, `rio convert`, `rio options`, and recordings for the other commands.
#include "recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "estimator_options.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "rio/bag/dataset_presets.hpp"
#include "rio/bag/recording.hpp"
#include "rio/bag/recording_writer.hpp"
#include "rio/bag/summary.hpp"
#include "rio/bag/turned.hpp"
#include "rio/io/dataset_stream.hpp"
#include "rio/io/options_yaml.hpp"
#include "rio/io/scan_folder.hpp"
#include "rio/io/units.hpp"

namespace rio::tools {

namespace fs = std::filesystem;

namespace {

void set(const std::string& said, std::string* value) {
  if (!said.empty()) *value = said;
}

/// @param said one of the names, checked by the command line
template <class Enum>
void set_named(const std::string& said, Enum* value) {
  const auto names = names_of(*value);
  const auto name = std::find(names.begin(), names.end(), said);
  if (name != names.end()) *value = static_cast<Enum>(name - names.begin());
}

/// The data set, overridden by the map, overridden by the command line.
bag::RecordingRequest request_of(const RecordingArguments& a, bool truth) {
  bag::RecordingRequest request;
  if (!a.dataset.empty()) request = bag::request_of(bag::dataset_preset(a.dataset));
  if (!a.map.empty()) request = bag::load_recording_map(a.map, std::move(request));
  set(a.imu, &request.imu_topic);
  set(a.radar, &request.radar_topic);
  set(a.pressure, &request.pressure_topic);
  set(a.truth, &request.truth_topic);
  request.truth = truth || !a.truth.empty();
  set_named(a.imu_clock, &request.imu_clock);
  set_named(a.radar_clock, &request.radar_clock);
  set(a.trigger, &request.trigger_topic);
  set_named(a.trigger_match, &request.trigger_match);
  if (!a.imu_offset.empty()) request.imu_offset = stamp_offset(a.imu_offset, "--imu-offset");
  if (!a.radar_offset.empty())
    request.radar_offset = stamp_offset(a.radar_offset, "--radar-offset");
  if (!a.gyro_unit.empty()) request.gyro_unit = io::unit_factor(a.gyro_unit, "rad/s");
  if (!a.accel_unit.empty()) request.accel_unit = io::unit_factor(a.accel_unit, "m/s^2");
  if (!a.imu_axes.empty()) set_named(a.imu_axes, &request.imu_axes.emplace());
  request.mounting_is_known = request.mounting_is_known || !a.sensors.empty();
  bag::PointRequest& points = request.points;
  if (!a.points.empty()) points.axes.clear();  // those of the data set
  set(a.points, &points.preset);
  for (const std::string& field : a.fields) points.fields.push_back({field, ""});
  set(a.axes, &points.axes);
  points.approaching = points.approaching || a.approaching;
  return request;
}

/// Replaces the properties of a radar, except those found from the data.
void take_radar_info(io::RadarInfo info, io::RadarInfo* radar) {
  if (!info.doppler_resolution) info.doppler_resolution = radar->doppler_resolution;
  if (!info.T_BS) info.is_from_tree = radar->is_from_tree;
  if (!info.T_BS) info.T_BS = radar->T_BS;
  info.fields = radar->fields;
  info.axes = radar->axes;
  *radar = std::move(info);
}

/// The same for all sensors of the recording.
void take_sensor_info(const fs::path& folder, io::Dataset* dataset) {
  io::Dataset info = io::read_sensor_info(folder);
  if (dataset->radar_info.T_BS) {  // of the recording
    std::erase_if(info.notes, [](const std::string& note) {
      return note.find("radar pose from the options") != std::string::npos;
    });
  }
  dataset->imu_info = info.imu_info;
  take_radar_info(info.radar_info, &dataset->radar_info);
  for (std::size_t i = 0; i < std::min(info.other_radars.size(), dataset->other_radars.size());
       ++i) {
    take_radar_info(info.other_radars[i].info, &dataset->other_radars[i].info);
  }
  dataset->notes.insert(dataset->notes.end(), info.notes.begin(), info.notes.end());
}

/// Mounting and notes of the data set; the sensor files win.
void take_settings(const std::string& path, const RecordingArguments& arguments,
                   io::Dataset* dataset) {
  if (!arguments.dataset.empty()) {
    const bag::DatasetPreset& preset = bag::dataset_preset(arguments.dataset);
    const std::string begin = std::string("data set ") + preset.name + ": ";
    if (bag::take_mounting(preset, &dataset->radar_info)) {
      dataset->notes.push_back(begin + "radar pose as published");
    }
    if (*preset.doubt != '\0') dataset->notes.push_back(begin + "not sure: " + preset.doubt);
  }
  if (!arguments.sensors.empty()) take_sensor_info(arguments.sensors, dataset);
  if (io::is_scan_folder(path) && !dataset->radar_info.T_BS) {
    dataset->notes.emplace_back("no mounting in the files: T_BS of --config or --sensors");
  }
}

/// Whether it is a ROS recording; throws if it is not, but options for one are given.
bool is_bag(const std::string& path, const RecordingArguments& arguments) {
  if (!io::is_dataset_folder(path) && bag::is_recording(path)) return true;
  RecordingArguments allowed;
  allowed.sensors = arguments.sensors;
  allowed.axes = arguments.axes;
  allowed.approaching = arguments.approaching;
  allowed.imu_axes = arguments.imu_axes;
  allowed.gyro_unit = arguments.gyro_unit;
  allowed.accel_unit = arguments.accel_unit;
  if (io::is_scan_folder(path)) allowed.dataset = arguments.dataset;
  if (arguments != allowed) {
    if (!io::is_dataset_folder(path)) (void)bag::open_messages(path);  // says what it is
    throw std::runtime_error(path +
                             ": options of a bag are given, but it is none: topics, clocks and "
                             "fields are those of its own files");
  }
  return false;
}

std::unique_ptr<io::RecordingStream> open_folder(const std::string& path,
                                                 const RecordingArguments& arguments,
                                                 io::Truth truth) {
  RecordingArguments own = arguments;
  own.dataset.clear();  // its axes are those of its bags
  own.sensors.clear();
  std::unique_ptr<io::RecordingStream> folder = io::open_dataset(path, truth);
  if (own == RecordingArguments{}) return folder;
  return bag::turned(std::move(folder), request_of(own, false));
}

/// IMU and radars by their stamps, as they would be received.
void write_mcap(const fs::path& out, const io::Dataset& dataset) {
  std::vector<const std::vector<RadarScan>*> radars = {&dataset.scans};
  for (const io::Dataset::OtherRadar& other : dataset.other_radars) radars.push_back(&other.scans);
  std::vector<std::size_t> next(radars.size(), 0);
  bag::RecordingWriter writer(out, radars.size());
  const auto add_scans_until = [&](Time time) {
    for (std::size_t r = 0; r < radars.size(); ++r) {
      const std::vector<RadarScan>& scans = *radars[r];
      for (; next[r] < scans.size() && scans[next[r]].time <= time; ++next[r]) {
        writer.add(scans[next[r]], r);
      }
    }
  };
  for (const ImuSample& sample : dataset.imu) {
    add_scans_until(sample.time);
    writer.add(sample);
  }
  add_scans_until(Time::max());
  writer.close();
}

/// What a bag of rio does not hold of this recording.
void print_what_is_left_out(const std::string& out, const std::string& source,
                            const io::Dataset& dataset) {
  std::string radars = dataset.other_radars.empty() ? "" : " --radar /radar0";
  bool sigmas = io::has_sigmas(dataset.scans);
  for (std::size_t r = 1; r <= dataset.other_radars.size(); ++r) {
    radars += fmt::format(",/radar{}", r);
    sigmas = sigmas || io::has_sigmas(dataset.other_radars[r - 1].scans);
  }
  fmt::print(
      "Not in the bag: mounting and noise, which `rio replay {} --sensors {}{}` takes{}{}{}.\n",
      out, source, radars, dataset.ground_truth.empty() ? "" : "; the ground truth",
      dataset.baro.empty() ? "" : "; the barometer", sigmas ? "; the sigmas of single points" : "");
}

/// Properties missing in every ROS recording.
void print_what_is_missing(const fs::path& out, bool mounted) {
  fmt::print(
      "Not in the recording, so fill in by hand before the first replay:\n"
      "  {}: {}what is known of max_doppler_mps, max_range_m, fov_azimuth_deg,\n"
      "    fov_elevation_deg\n"
      "  {}: the noise densities of the data sheet\n",
      (out / "radar0" / "sensor.yaml").string(),
      mounted ? ""
              : "T_BS, the pose of the radar in the IMU frame (until then both are taken to be "
                "one\n    frame), and ",
      (out / "imu0" / "sensor.yaml").string());
}

}  // namespace

double stamp_offset(const std::string& said, const char* option) {
  constexpr double kMost = 4e9;  // [s] a stamp has room for twice as much
  const double seconds = said.empty() ? 0.0 : io::parse_quantity(said, "s");
  if (std::abs(seconds) <= kMost) return seconds;
  throw std::runtime_error(
      fmt::format("{} {}: no offset of stamps, which is at most {:g} s", option, said, kMost));
}

io::Dataset read_any(const std::string& path, const RecordingArguments& arguments, bool truth) {
  io::Dataset dataset = is_bag(path, arguments)
                            ? bag::read_recording(path, request_of(arguments, truth))
                            : io::collect(open_folder(path, arguments, io::Truth::kAll).get());
  take_settings(path, arguments, &dataset);
  return dataset;
}

OpenRecording open_any(const std::string& path, const RecordingArguments& arguments, bool truth) {
  OpenRecording out;
  out.samples = is_bag(path, arguments) ? bag::open_recording(path, request_of(arguments, truth))
                                        : open_folder(path, arguments, io::Truth::kStart);
  out.sensors = out.samples->outline().sensors;
  take_settings(path, arguments, &out.sensors);
  return out;
}

std::string scans_text(const io::Dataset& dataset) {
  std::string text = std::to_string(dataset.scans.size());
  for (const io::Dataset::OtherRadar& other : dataset.other_radars) {
    text += fmt::format(" + {}", other.scans.size());
  }
  return text + " scans";
}

void throw_damage(const std::string& damage) {
  if (!damage.empty()) throw std::runtime_error(damage + "\nWhat stands before was used.");
}

void info(const std::string& path) {
  if (io::is_scan_folder(path)) {
    const io::RecordingOutline outline = io::open_scan_folder(path)->outline();
    fmt::print("{}: {} IMU samples, {} scans in files\n", path, outline.imu_samples,
               outline.scan_times[0].size());
    return print_notes(outline.sensors.notes);
  }
  const bag::Summary summary = bag::summarise(bag::open_messages(path).get());
  fmt::print("{}: {}", path, bag::summary_text(summary));
  throw_damage(summary.damage);
}

void convert(const ConvertArguments& arguments) {
  protect_inputs({arguments.recording}, {arguments.out});
  const fs::path out = arguments.out;
  const bool to_bag = out.extension() == ".mcap";
  const bool taken =
      to_bag ? fs::exists(out) : fs::exists(out / "imu0") || fs::exists(out / "radar0");
  if (taken && !arguments.force) {
    throw std::runtime_error(out.string() + ": holds a recording already; --force overwrites it");
  }
  const io::Dataset dataset = [&] {
    const Busy busy("reading");
    return read_any(arguments.recording, arguments.how, true);
  }();
  print_notes(dataset.notes);
  const bool is_folder = io::is_asl_folder(arguments.recording);
  {
    const Busy busy("writing");
    if (to_bag && arguments.force) fs::remove(out);
    to_bag ? write_mcap(out, dataset) : io::write_dataset(out, dataset);
  }
  fmt::print("Written to {}: {} IMU samples, {}.\n", out.string(), dataset.imu.size(),
             scans_text(dataset));
  if (to_bag)
    print_what_is_left_out(out.string(), is_folder ? arguments.recording : "FOLDER", dataset);
  if (!to_bag && !is_folder) print_what_is_missing(out, dataset.radar_info.T_BS.has_value());
  throw_damage(dataset.damage);
}

void print_options(const OptionsArguments& arguments) {
  if (arguments.compare) return fmt::print("{}", io::presets_as_table());
  if (arguments.dataset.empty()) {
    const std::string& name = arguments.estimator.preset;
    return fmt::print("{}", io::option_file(name.empty() ? "default" : name));
  }
  const OpenRecording recording = open_any(arguments.dataset, arguments.how);
  print_notes(recording.sensors.notes);
  const Options options = make_options(arguments.estimator, recording.sensors);
  if (options.radars() > 1) {
    fmt::print("# Of radar0; that of the others is in their sensor.yaml, with these defaults.\n");
  }
  fmt::print("{}", io::options_as_yaml(options));
}

}  // namespace rio::tools
