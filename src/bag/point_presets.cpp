// SPDX-License-Identifier: BSD-3-Clause
#include "point_presets.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <stdexcept>

namespace rio::bag {

namespace {

constexpr PointPreset kPointPresets[] = {
    {"ti", "TI driver ti_mmwave_rospkg: axes turned to forward, left, up; intensity is the SNR",
     Axes::kFlu, "x=x y=y z=z doppler=velocity snr=intensity", "", true},
    {"rio", "clouds of the ekf-rio data sets: axes of the chip", Axes::kTi,
     "x=x y=y z=z doppler=v_doppler_mps snr=snr_db noise=noise_db", "range", true},
    {"mav", "mav_sensors: axes of the chip, SNR and noise in 0.1 dB", Axes::kTi,
     "x=x y=y z=z doppler=doppler snr=snr*0.1 noise=noise*0.1", "", true},
    {"coloradar", "ColoRadar: axes of the chip", Axes::kTi,
     "x=x y=y z=z doppler=doppler snr=intensity", "range", true,
     "the TI driver of ibcn has the same fields in forward, left, up: --axes flu"},
    {"mimosa", "x y z intensity velocity in the axes of the mounting that comes with it",
     Axes::kFlu, "x=x y=y z=z doppler=velocity snr=intensity", "doppler_residual", false},
    {"pointxyzi", "Doppler hidden as float32 at byte 12 of x y z intensity: axes of the chip",
     Axes::kTi, "x=x y=y z=z doppler=@12 snr=intensity", "", false},
    {"msc", "MSC-RAD4R (Oculii Eagle): right, down, forward", Axes::kRdf,
     "x=x y=y z=z doppler=doppler snr=power", "alpha beta range recoveredSpeed denoiseFlag", true},
    {"ars548", "Continental ARS548: polar, with the sigmas of each point", Axes::kFlu,
     "range=range azimuth=azimuth elevation=elevation doppler=velocity sigma_range=rangeSTD "
     "sigma_azimuth=azimuthSTD sigma_elevation=elevationSTD sigma_doppler=velocitySTD",
     "rcs", true},
    {"eagle",
     "NTU4DRadLM (Oculii Eagle as the older PointCloud): the first channel is the Doppler, the "
     "third the power",
     Axes::kFlu, "x=x y=y z=z doppler=#3 snr=#5", "", false},
    {"altos", "Altos as PointXYZHSV: h is the Doppler", Axes::kFlu, "x=x y=y z=z doppler=h", "s v",
     true},
};

bool fits(const PointPreset& preset, const std::vector<PointField>& fields) {
  constexpr std::uint8_t kFloat32 = 7;
  std::map<std::string, bool> needed;  // and whether it has a scale
  for (const std::string& word : words_of(preset.fields)) {
    const std::string source = split_rule(word).second;
    const std::size_t star = source.find('*');
    needed[source.substr(0, star)] = star != std::string::npos;
  }
  const std::vector<std::string> others = words_of(preset.others);
  for (const PointField& field : fields) {
    const auto known = needed.find(field.name);
    if (known != needed.end() && known->second && field.datatype >= kFloat32) return false;
    const bool other = std::find(others.begin(), others.end(), field.name) != others.end();
    if (known == needed.end() && !other) return false;
    if (known != needed.end()) needed.erase(known);
  }
  return needed.empty();
}

}  // namespace

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::pair<std::string, std::string> split_rule(const std::string& rule) {
  const std::size_t equals = rule.find('=');
  if (equals == std::string::npos) {
    throw std::runtime_error("\"" + rule + "\": should be QUANTITY=FIELD or " +
                             "QUANTITY=FIELD*SCALE");
  }
  return {rule.substr(0, equals), rule.substr(equals + 1)};
}

const PointPreset* find_preset(const PointRequest& request, const std::vector<PointField>& fields) {
  for (const PointPreset& preset : kPointPresets) {
    if (request.preset.empty() ? preset.recognised && fits(preset, fields)
                               : request.preset == preset.name) {
      return &preset;
    }
  }
  if (request.preset.empty()) return nullptr;
  throw std::runtime_error("no such preset of points: \"" + request.preset + "\"; there are\n" +
                           point_presets());
}

std::string point_presets() {
  std::string text;
  for (const PointPreset& preset : kPointPresets) {
    text += std::string("  ") + preset.name + ": " + preset.meaning + "\n";
  }
  return text;
}

}  // namespace rio::bag
