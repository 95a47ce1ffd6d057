// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/recording.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "io/fields_yaml.hpp"
#include "rio/io/units.hpp"

namespace rio::bag {

namespace {

constexpr const char* kFields = "radar.fields";  // has keys of its own

/// The keys of the file, except those of the fields.
struct MapFile {
  RecordingRequest request;
  Axes imu_axes{};
  std::string gyro_unit;
  std::string accel_unit;
};

template <class Visitor>
void visit_fields(MapFile& file, const Visitor& visit) {
  constexpr double kLongest = 1e6;  // [s]
  const auto field = [&visit](const char* key, auto& value, const char* unit = "") {
    visit(FieldInfo{key, unit, "", -kLongest, kLongest}, value);
  };
  RecordingRequest& request = file.request;
  field("imu.topic", request.imu_topic);
  field("imu.clock", request.imu_clock);
  field("imu.offset", request.imu_offset, "s");
  field("imu.axes", file.imu_axes);
  field("imu.gyro_unit", file.gyro_unit);
  field("imu.accel_unit", file.accel_unit);
  field("pressure.topic", request.pressure_topic);
  field("truth.topic", request.truth_topic);
  field("radar.topic", request.radar_topic);
  field("radar.clock", request.radar_clock);
  field("radar.trigger", request.trigger_topic);
  field("radar.trigger_match", request.trigger_match);
  field("radar.offset", request.radar_offset, "s");
  field("radar.points", request.points.preset);
  field("radar.axes", request.points.axes);
  field("radar.approaching", request.points.approaching);
}

/// The value under two nested keys; undefined if there is none.
YAML::Node find(const io::YamlFile& file, const char* section, const char* key) {
  const YAML::Node inner = file.root[section];
  return inner.IsDefined() && inner.IsMap() ? inner[key] : YAML::Node(YAML::NodeType::Undefined);
}

double unit_of(const io::YamlFile& file, const char* key, const std::string& name, const char* si) {
  if (name.empty()) return 1.0;
  try {
    return io::unit_factor(name, si);
  } catch (const std::invalid_argument& error) {
    io::fail_at(file, find(file, "imu", key), std::string("imu.") + key + ": " + error.what());
  }
}

std::string place_of(const io::YamlFile& file, const YAML::Node& node) {
  return file.name + ":" + std::to_string(node.Mark().line + 1);
}

/// One name of a field, or a list of alternatives, each with an optional scale.
/// @param key for messages
std::string sources_of(const io::YamlFile& file, const YAML::Node& key, const YAML::Node& node) {
  if (node.IsScalar() && !node.Scalar().empty()) return node.Scalar();
  std::string all;
  bool names = node.IsSequence() && node.size() > 0;
  for (std::size_t i = 0; names && i < node.size(); ++i) {
    names = node[i].IsScalar();
    if (names) all += (i == 0 ? "" : ",") + node[i].Scalar();
  }
  if (!names) io::fail_at(file, key, "the name of a field, or a list of them, is expected");
  return all;
}

void read_point_fields(const io::YamlFile& file, PointRequest* points) {
  const YAML::Node radar = file.root["radar"];
  if (radar.IsDefined()) points->where = place_of(file, radar);
  const YAML::Node fields = find(file, "radar", "fields");
  if (!fields.IsDefined()) return;
  if (!fields.IsMap()) io::fail_at(file, fields, std::string(kFields) + ": a map is expected");
  for (const auto& entry : fields) {
    points->fields.push_back(
        {entry.first.Scalar() + "=" + sources_of(file, entry.first, entry.second),
         place_of(file, entry.first)});
  }
}

}  // namespace

RecordingRequest load_recording_map(const std::filesystem::path& path, RecordingRequest base) {
  const io::YamlFile file = io::load_yaml(path);
  MapFile map;
  map.request = std::move(base);
  io::read_fields(file, kFields, &map);
  if (find(file, "imu", "axes").IsDefined()) map.request.imu_axes = map.imu_axes;
  map.request.gyro_unit = unit_of(file, "gyro_unit", map.gyro_unit, "rad/s");
  map.request.accel_unit = unit_of(file, "accel_unit", map.accel_unit, "m/s^2");
  read_point_fields(file, &map.request.points);
  return map.request;
}

}  // namespace rio::bag
