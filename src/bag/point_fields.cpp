// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/point_fields.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "point_presets.hpp"

namespace rio::bag {

namespace {

constexpr std::array<const char*, kQuantityCount> kNames = {
    "x",   "y",     "z",           "range",         "azimuth",         "elevation",    "doppler",
    "snr", "noise", "sigma_range", "sigma_azimuth", "sigma_elevation", "sigma_doppler"};

/// Lower-case names of a quantity when nothing else is specified; the sigmas have none.
constexpr std::array<const char*, kNoise + 1> kAliases = {
    "x",
    "y",
    "z",
    "range r",
    "azimuth azimuth_angle",
    "elevation elevation_angle",
    "doppler velocity v_doppler_mps doppler_velocity radial_velocity radial_speed range_rate rdot "
    "v_r vr",
    "snr snr_db intensity power amplitude",
    "noise noise_db"};

constexpr auto kAxesNames = names_of(Axes::kFlu);
constexpr std::array<const char*, 4> kAxesMeanings = {
    "x forward, y left, z up", "TI's: x right, y forward, z up", "x right, y down, z forward",
    "x forward, y right, z down"};

std::size_t quantity_of(const std::string& name) {
  const auto known = std::find(kNames.begin(), kNames.end(), name);
  if (known != kNames.end()) return static_cast<std::size_t>(known - kNames.begin());
  std::string all;
  for (const char* each : kNames) all += std::string(" ") + each;
  throw std::runtime_error("\"" + name + "\" is no quantity of a point; there are" + all);
}

/// The number in "@12" or "#12".
std::optional<std::uint32_t> place_of(const std::string& name) {
  if (name.size() < 2 || name.size() > 6 || (name[0] != '@' && name[0] != '#')) return std::nullopt;
  if (!std::all_of(name.begin() + 1, name.end(), [](char c) { return c >= '0' && c <= '9'; })) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(std::stoul(name.substr(1)));
}

/// Prefixes errors thrown by `work` with the position.
template <class Work>
void naming(const std::string& where, const Work& work) {
  if (where.empty()) return work();
  try {
    work();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(where + ": " + error.what());
  }
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Of what a point may do without: not finite is not given.
double finite_or_zero(double value) {
  return std::isfinite(value) ? value : 0.0;
}

}  // namespace

Vector3d to_flu(Axes axes, const Vector3d& v) {
  switch (axes) {
    case Axes::kTi:
      return {v.y(), -v.x(), v.z()};
    case Axes::kRdf:
      return {v.z(), -v.x(), -v.y()};
    case Axes::kFrd:
      return {v.x(), -v.y(), -v.z()};
    case Axes::kFlu:
      break;
  }
  return v;
}

Matrix3d flu_from(Axes axes) {
  Matrix3d R;
  for (int i = 0; i < 3; ++i) R.col(i) = to_flu(axes, Vector3d::Unit(i));
  return R;
}

Axes axes_named(const std::string& name) {
  const auto axes = std::find(kAxesNames.begin(), kAxesNames.end(), name);
  if (axes == kAxesNames.end()) throw std::runtime_error("no such axes: \"" + name + "\"");
  return static_cast<Axes>(axes - kAxesNames.begin());
}

PointMap::PointMap(const std::vector<PointField>& fields, const PointRequest& request)
    : fields_(fields) {
  for (auto rule = request.fields.rbegin(); rule != request.fields.rend(); ++rule) {
    naming(rule->where, [&] { set_by_rule(rule->text); });
  }
  naming(request.where, [&] { set_by(request); });
}

/// Quantities that no rule has set.
void PointMap::set_by(const PointRequest& request) {
  const PointPreset* preset = find_preset(request, fields_);
  origin_ = preset == nullptr ? "by their names" : std::string("preset ") + preset->name;
  if (preset != nullptr) {
    axes_ = preset->axes;
    if (request.axes.empty() && request.preset.empty()) doubt_ = preset->doubt;
    for (const std::string& assignment : words_of(preset->fields)) {
      set_by_rule(assignment);
    }
  } else {
    match_names();
  }
  if (!request.axes.empty()) {
    axes_ = axes_named(request.axes);
  }
  settle_point();
  if (request.approaching) sources_[kDoppler]->scale *= -1.0;
}

/// Unless the quantity is set.
void PointMap::set_by_rule(const std::string& rule) {
  const auto [name, alternatives] = split_rule(rule);
  std::optional<Source>& source = sources_[quantity_of(name)];
  if (source) return;
  std::string first;
  std::string blanks = alternatives;
  std::replace(blanks.begin(), blanks.end(), ',', ' ');
  for (const std::string& text : words_of(blanks)) {
    const std::size_t star = text.rfind('*');
    const auto field = find(text.substr(0, star));
    if (!field) continue;
    if (source) {
      fail("two fields may be the " + name + ", \"" + first + "\" and \"" + text + "\"");
    }
    first = text;
    source = Source{*field};
    if (star == std::string::npos) continue;
    std::istringstream number(text.substr(star + 1));
    if (!(number >> source->scale) || !number.eof()) fail("\"" + text + "\": no scale");
  }
  if (!source) fail("no field \"" + alternatives + "\" for the " + name);
}

/// @param name "velocity", "#3" for the field after three others, or "@12" for a float32 at byte 12
std::optional<PointField> PointMap::find(const std::string& name) const {
  constexpr std::uint8_t kFloat32 = 7;
  for (const PointField& field : fields_) {
    if (field.name == name) return field;
  }
  const auto place = place_of(name);
  if (place && name[0] == '@') return PointField{name, *place, kFloat32};
  if (place && *place < fields_.size()) return fields_[*place];
  return std::nullopt;
}

/// Of what a point may do without, the first of the known names; else two of them are an error.
void PointMap::match_names() {
  for (std::size_t q = 0; q < kAliases.size(); ++q) {
    if (sources_[q]) continue;
    const std::string name = kNames[q];
    for (const std::string& alias : words_of(kAliases[q])) {
      for (const PointField& field : fields_) {
        if (lower(field.name) != alias || (sources_[q] && q >= kSnr)) continue;
        if (sources_[q]) {
          const std::string& first = sources_[q]->field.name;
          fail("two fields may be the " + name + ", \"" + first + "\" and \"" + field.name +
               "\": choose with --field " + name + "=" + first);
        }
        sources_[q] = Source{field};
      }
    }
  }
}

void PointMap::settle_point() {
  const bool cartesian = sources_[kX] && sources_[kY] && sources_[kZ];
  const bool polar = sources_[kRange] && sources_[kAzimuth] && sources_[kElevation];
  if (!cartesian && !polar) fail("neither x y z nor range, azimuth and elevation");
  for (const Quantity unused :
       {cartesian ? kRange : kX, cartesian ? kAzimuth : kY, cartesian ? kElevation : kZ}) {
    sources_[unused].reset();
  }
  if (!sources_[kDoppler]) {
    fail("no Doppler; name it with --field doppler=NAME, or one that a driver hides with --points");
  }
}

std::size_t PointMap::convert(const PointCloud& cloud,
                              std::vector<RadarDetection>* detections) const {
  for (const auto& source : sources_) {
    if (source && cloud.size() > 0 &&
        std::uint64_t{source->field.offset} + datatype_size(source->field.datatype) >
            cloud.point_step) {
      fail("field \"" + source->field.name + "\" is outside of a point");
    }
  }
  std::size_t left_out = 0;
  for (std::uint64_t i = 0; i < cloud.size(); ++i) {
    const auto get = [&](Quantity q) { return number(cloud, i, q); };
    RadarDetection d;
    if (sources_[kX]) {
      d.point_S = {get(kX), get(kY), get(kZ)};
    } else {
      const double flat = get(kRange) * std::cos(get(kElevation));
      d.point_S = {flat * std::cos(get(kAzimuth)), flat * std::sin(get(kAzimuth)),
                   get(kRange) * std::sin(get(kElevation))};
    }
    d.point_S = to_flu(axes_, d.point_S);
    d.range_rate = get(kDoppler);
    d.snr_db = finite_or_zero(get(kSnr));
    d.noise_db = finite_or_zero(get(kNoise));
    const std::array<double*, 4> sigmas = {&d.sigma_range, &d.sigma_azimuth, &d.sigma_elevation,
                                           &d.sigma_doppler};
    for (std::size_t k = 0; k < sigmas.size(); ++k) {
      *sigmas[k] = std::max(0.0, finite_or_zero(get(static_cast<Quantity>(kSigmaRange + k))));
    }
    if (d.point_S.allFinite() && std::isfinite(d.range_rate)) {
      detections->push_back(d);
    } else {
      ++left_out;
    }
  }
  return left_out;
}

double PointMap::number(const PointCloud& cloud, std::uint64_t point, std::size_t quantity) const {
  const auto& source = sources_[quantity];
  if (!source) return 0.0;
  return source->scale * number_of_type(cloud.point(point).data() + source->field.offset,
                                        source->field.datatype, cloud.big_endian);
}

void PointMap::check_angles(const PointCloud& cloud) const {
  constexpr double kTurn = 6.4;      // of an azimuth, counted from 0 or both ways [rad]
  constexpr double kHalfTurn = 3.2;  // of an elevation, from the horizon or the zenith [rad]
  if (!sources_[kRange]) return;
  std::size_t beyond = 0;
  std::size_t behind = 0;
  for (std::uint64_t i = 0; i < cloud.size(); ++i) {
    behind += number(cloud, i, kRange) < 0.0 ? 1 : 0;
    const bool turns = std::abs(number(cloud, i, kAzimuth)) > kTurn ||
                       std::abs(number(cloud, i, kElevation)) > kHalfTurn;
    beyond += turns ? 1 : 0;
  }
  if (2 * behind > cloud.size()) {
    fail("ranges below zero: --field range=" + sources_[kRange]->field.name + "*-1");
  }
  if (beyond < 2) return;  // one may be corrupt
  std::string how;
  for (const Quantity q : {kAzimuth, kElevation, kSigmaAzimuth, kSigmaElevation}) {
    if (!sources_[q]) continue;
    how += std::string(" --field ") + kNames[q] + "=" + sources_[q]->field.name + "*0.0174533";
  }
  fail("angles in degrees:" + how);
}

void PointMap::name(io::RadarInfo* info) const {
  info->axes = kAxesNames[static_cast<std::size_t>(axes_)];
  info->fields.clear();
  for (std::size_t q = 0; q < sources_.size(); ++q) {
    if (!sources_[q]) continue;
    std::ostringstream source;
    source << sources_[q]->field.name;
    if (sources_[q]->scale != 1.0) source << "*" << sources_[q]->scale;
    info->fields.emplace_back(kNames[q], source.str());
  }
}

std::string PointMap::text() const {
  io::RadarInfo info;
  name(&info);
  std::string text = origin_ + ":";
  for (const auto& [quantity, source] : info.fields) text += " " + quantity + "=" + source;
  return text + "; axes " + kAxesMeanings[static_cast<std::size_t>(axes_)] +
         "; doppler positive = receding" + (sources_[kSnr] ? "" : "; no SNR") +
         (doubt_.empty() ? "" : "; " + doubt_);
}

void PointMap::fail(const std::string& what) const {
  throw std::runtime_error("points: " + what + " (fields found: " +
                           (fields_.empty() ? "none" : fields_text(fields_)) + ")");
}

}  // namespace rio::bag
