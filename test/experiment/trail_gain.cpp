// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/trail_gain.hpp"

#include <fmt/format.h>

#include <functional>
#include <utility>

#include "experiment/spread.hpp"
#include "rio/sim/catalogue.hpp"

namespace rio::experiment {

namespace {

/// One change to the radar of the flights.
struct Radar {
  const char* name;
  std::function<void(sim::RadarModel&)> change;
};

const std::vector<Radar>& radars() {
  static const std::vector<Radar> all = {
      {"as in the flights above", [](sim::RadarModel&) {}},
      {"Doppler noise of 0.3 m/s", [](sim::RadarModel& r) { r.sigma_doppler = 0.3; }},
      {"Doppler grid of 0.5 m/s", [](sim::RadarModel& r) { r.doppler_resolution = 0.5; }},
      {"Doppler grid of 0.5 m/s, angles of 0.5 deg",
       [](sim::RadarModel& r) {
         r.doppler_resolution = 0.5;
         r.sigma_azimuth = r.sigma_elevation = 0.5 * sim::kDegree;
         r.angle_grid = 0.0;
       }},
      {"field of 40 by 20 deg",
       [](sim::RadarModel& r) {
         r.fov_azimuth = 40.0 * sim::kDegree;
         r.fov_elevation = 20.0 * sim::kDegree;
       }},
      {"six points a scan",
       [](sim::RadarModel& r) {
         r.max_static = 6;
         r.threshold_db = 13.0;
       }},
  };
  return all;
}

std::vector<Variant> columns() {
  std::vector<Variant> all = {{"Doppler", "published-ekf", [](Options& o) {
                                 o.update.use_trails = o.update.use_landmarks = false;
                               }}};
  for (Variant& v : clone_variants()) all.push_back(std::move(v));
  all.push_back({"default", "default"});
  all.push_back({"default with trails", "default", [](Options& o) { o.update.use_trails = true; }});
  return all;
}

}  // namespace

std::vector<Variant> clone_variants() {
  const auto clones = [](int count) {  // a trail becomes a landmark at this length
    return [=](Options& o) { o.update.max_clones = o.frontend.promote_after = count; };
  };
  return {{kOnePastScan, "published-ekf",
           [](Options& o) {
             o.update.max_clones = 1;
             o.update.use_landmarks = false;
           }},
          {"published-ekf: N = 7", "published-ekf", clones(7)},
          {"published-ekf: N = 10", "published-ekf", clones(10)}};
}

std::string trail_gain_table(const Settings& settings, std::vector<Outcome>* runs) {
  const std::vector<Variant> variants = columns();
  std::vector<Case> cases;
  std::vector<std::string> groups;
  for (const Radar& radar : radars()) {
    groups.emplace_back(radar.name);
    for (std::size_t i = 0; i < sim::kIcraLengths.size(); ++i) {
      Case c = cases_of(fmt::format("indoor-{}", i + 1), 1).front();
      c.group = radar.name;
      radar.change(c.scenario.radar);
      cases.push_back(std::move(c));
    }
  }
  groups.emplace_back("hover");
  for (Case& c : cases_of("hover", static_cast<int>(sim::kIcraLengths.size()))) {
    cases.push_back(std::move(c));
  }
  std::vector<Outcome> flown = run_campaign(cases, variants, settings);

  std::vector<std::string> head = {"radar (7 flights)"};
  for (const Variant& v : variants) {
    head.push_back(v.name.substr(v.name.find(':') == std::string::npos ? 0 : v.name.find(':') + 2));
  }
  MarkdownTable table(head);
  for (const std::string& group : groups) {
    std::vector<std::string> row = {group};
    for (const Variant& v : variants) {
      const std::vector<Score> scores = select(flown, group, v.name);
      const Spread mae = Spread::of(scores, &Score::mae);
      std::string cell = fmt::format("{} / {}", number(Spread::of(scores, &Score::drift).mean, 2),
                                     number(mae.mean, 2));
      if (count_lost(scores) > 0) cell += fmt::format(" (lost: {})", count_lost(scores));
      row.push_back(cell);
    }
    table.add(row);
  }
  for (Outcome& run : flown) runs->push_back(std::move(run));
  return table.text();
}

}  // namespace rio::experiment
