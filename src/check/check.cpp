// SPDX-License-Identifier: BSD-3-Clause
#include "check/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/clock_steps.hpp"
#include "check/imu_check.hpp"
#include "check/motion.hpp"
#include "check/motion_check.hpp"
#include "check/numbers.hpp"
#include "check/order.hpp"
#include "check/points_check.hpp"
#include "check/radar_check.hpp"

namespace rio::check {

namespace {

/// Whether distances and stamps are right: otherwise the other checks would report what follows
/// from these.
bool has_sound_basis(const Findings& findings) {
  return std::ranges::none_of(findings, [](const Finding& finding) {
    const bool basic = finding.subject == "distances" || finding.subject == "radar stamps";
    return basic && finding.verdict == Verdict::kWrong;
  });
}

/// Empty if the radar is as near to the IMU as in a car.
std::optional<Finding> check_lever_arm(const Vector3d& p) {
  constexpr double kFarthest = 5.0;  // from the rear axle of a car to its front [m]
  if (p.norm() < kFarthest) return std::nullopt;
  return Finding{Verdict::kDoubtful, "lever arm",
                 fmt::format("the radar is {:.3g} m from the IMU", p.norm()),
                 "the translation of T_BS is in metres: is this one in mm or cm?"};
}

/// How to get stamps in ns, if those of the IMU are in this unit [ns].
std::string other_stamps(double unit, const Scans& scans, Source source) {
  const bool all = stamp_unit(scans) != 1.0;
  std::string change;
  if (source == Source::kBag) {
    change = all ? "--imu-clock receive --radar-clock receive, or " : "--imu-clock receive, or ";
  }
  return change + fmt::format("multiply the stamps of {} by {:.0f}: they must be in ns",
                              all ? "all sensors" : "the IMU", unit);
}

/// The motion is that of the points which do not agree with most.
/// @param others what they explain
Finding most_points_move(const Finding& others) {
  return {
      Verdict::kDoubtful, "axes and Doppler sign",
      "the velocity that most points of a scan agree on is not that of the IMU, the velocity of "
      "the others is: " +
          others.text,
      "most points move: record the detections, not tracks, with clutter removal off and fewer "
      "moving objects"};
}

/// Half of a velocity is so uncertain that its scale alone may not show the error.
Scans with_twice_the_doppler(const Scans& scans) {
  return changed(scans, [](std::size_t, RadarScan* scan) {
    for (RadarDetection& d : scan->detections) d.range_rate *= 2.0;
  });
}
/// @param twice what it explains with twice of it
Finding doppler_is_half(const Finding& twice, const Advice& advice) {
  return {Verdict::kWrong, "Doppler scale",
          "the Doppler is half the range rate; taken twice, " + twice.text,
          advice.scale("doppler", 2.0)};
}

/// Says the steps of a clock: those back in place of what was found of the stamps without them.
/// @param items scans or samples as recorded
/// @param sensor "radar" or "imu"
template <class Items>
void say_steps(const std::vector<ClockStep>& steps, const Items& items, const char* item,
               const std::string& sensor, Findings* out) {
  const std::string change =
      std::string("nothing for `rio replay`, which takes it out; for others, ") + kSplitThere;
  Jump back;
  for (const ClockStep& step : steps) {
    const double size = to_seconds(step.size);
    if (size <= kBack) {
      if (back.count++ == 0) back = {1, step.first, size};
      continue;
    }
    out->push_back(
        {Verdict::kWrong, "delay of the radar",
         fmt::format("a clock steps within the recording: from {} {} on, {:.1f} s after the first, "
                     "the stamps of the {} are {:+.3f} s off those before",
                     item, step.first + 1, to_seconds(items[step.first - 1].time - items[0].time),
                     sensor, size),
         change});
  }
  if (back.count == 0) return;
  const std::string subject = sensor + " stamps";
  std::erase_if(*out, [&subject](const Finding& f) { return f.subject == subject; });
  out->push_back({Verdict::kDoubtful, subject,
                  fmt::format("from {} {} on", item, back.first + 1) + jump_text(back), change});
}

/// A radar; `options` have it as the first one.
/// @param steps of its clock
Findings check_one_radar(const CheckedImu& imu, const Scans& recorded,
                         const std::vector<ClockStep>& steps, const io::RadarInfo& info,
                         const Advice& advice, const Options& options,
                         const std::filesystem::path& folder) {
  if (recorded.empty()) return {};
  const std::optional<Scans> moved =
      steps.empty() ? std::nullopt : std::optional(without_steps(recorded, steps));
  const Scans& scans = moved ? *moved : recorded;
  Findings out = {check_clocks(imu.all, scans, advice)};
  if (stamp_unit(scans) != 1.0) return out;
  Options read = options;
  double& limit = read.radar.max_doppler;
  constexpr double kHalf = 0.6;  // and some noise
  if (limit > 0.0) limit = std::max(limit, fastest(scans));
  const std::vector<RadarSpeed> speeds = radar_speeds(scans, read);
  if (const auto lever = check_lever_arm(options.radar.T_BS.translation)) out.push_back(*lever);
  const auto append = [&out](const Findings& more) {
    out.insert(out.end(), more.begin(), more.end());
  };
  const Findings alone =
      check_radar(scans, info, speeds, imu, options, advice, folder / advice.csv());
  append(alone);
  if (const auto elevations = check_elevations(scans, advice)) {
    out.push_back(*elevations);
    return out;
  }
  say_steps(steps, recorded, "scan", "radar", &out);
  if (!has_sound_basis(alone)) {  // beyond the limit points have no velocity
    const auto follows = [](const Finding& f) {
      return f.subject == "points" && f.verdict == Verdict::kDoubtful;
    };
    std::erase_if(out, follows);
    return out;
  }
  if (const auto repeated = check_repeated(scans)) out.push_back(*repeated);
  if (const auto origin = check_origin(scans, advice)) out.push_back(*origin);
  const RangeCheck ranges = check_ranges(scans, options, advice);
  out.push_back(ranges.finding);
  if (!imu.check.integrable) return out;
  double gyro_unit = imu.check.gyro_unit;
  if (gyro_unit == 1.0) {
    if (const auto unit = check_rates(imu.good, scans, options, advice)) {
      out.push_back(*unit);
      if (imu.check.exchanged) out.back().change += " when they are exchanged";
      gyro_unit = kDegree;
    }
  }
  const auto judged = [&](const std::vector<RadarSpeed>& some, double scale_error) {
    return check_motion({imu, some, gyro_unit, ranges.sign, scale_error}, options, advice);
  };
  constexpr double kSlight = 1.25;
  Findings motion = judged(speeds, kSlight);
  if (motion.size() == 1) {  // explains nothing
    const auto some = radar_speeds(without_points_of(speeds, scans, limit), read);
    const Findings others = judged(some, kSlight);
    if (others.size() > 1 && worst(others) == Verdict::kOk) motion = {most_points_move(others[0])};
  }
  const bool may_be_half = !(limit > 0.0) || fastest(scans) < kHalf * limit;
  if (may_be_half && worst(motion) == Verdict::kOk) {
    const std::vector<RadarSpeed> doubled = radar_speeds(with_twice_the_doppler(scans), read);
    const auto fits = [&](const std::vector<RadarSpeed>& some) {
      const Findings found = judged(some, 1.0);  // twice the right Doppler is not much off, either
      return found.size() > 1 && worst(found) == Verdict::kOk ? found : Findings();
    };
    const Findings twice = fits(doubled);
    if (!twice.empty() && fits(speeds).empty()) motion = {doppler_is_half(twice[0], advice)};
  }
  if (motion[0].subject == "Doppler") {  // beyond its limit, or of odd rates, for the same reason
    std::erase_if(out, [](const Finding& f) {
      return f.subject == "Doppler" || f.subject == "Doppler by the ranges";
    });
  }
  append(motion);
  return out;
}

/// Options of a bag are for the points of all radars: one that not all need is not proposed as
/// such.
void propose_edits_of_one_radar(std::vector<Findings>* radars) {
  const std::vector<Findings> said = *radars;
  const auto is_for_points = [](const std::string& change) {
    constexpr const char* kOptions[] = {"--approaching", "--axes", "--field"};
    return std::ranges::any_of(kOptions, [&](const char* o) { return change.starts_with(o); });
  };
  for (std::size_t r = 0; r < said.size(); ++r) {
    for (Finding& f : (*radars)[r]) {
      const auto has_it = [&f](const Findings& of) {
        return std::ranges::any_of(of, [&f](const Finding& g) { return g.change == f.change; });
      };
      if (!is_for_points(f.change) || std::ranges::all_of(said, has_it)) continue;
      f.change = fmt::format(
          "if it is radar{0} alone: `rio convert`, then edit the files of radar{0} as `rio check` "
          "of the folder says; for all radars {1}",
          r, f.change);
    }
  }
}

Findings check_all(const std::vector<ImuSample>& recorded, const std::vector<Scans>& radars,
                   const io::Dataset& sensors, const Options& options, Source source,
                   const std::filesystem::path& folder) {
  const ClockSteps steps = find_clock_steps(recorded, radars, sensors.imu_info, options);
  std::vector<ImuSample> moved;
  if (!steps.imu.empty()) moved = without_steps(recorded, steps.imu);
  const std::vector<ImuSample>& samples = steps.imu.empty() ? recorded : moved;
  const Usable usable(samples);
  const std::vector<ImuSample>& good = usable.good();
  const ImuCheck check = check_imu(usable, sensors.imu_info, source, folder / "imu0" / "data.csv");
  Findings out = check.findings;
  if (check.stamp_unit != 1.0) {
    out.back().change = other_stamps(check.stamp_unit, radars[0], source);
  }
  if (samples.empty() || check.stamp_unit != 1.0) return out;
  std::vector<ImuSample> other_way;  // the other checks are then as with the right columns
  if (check.exchanged) other_way = good;
  for (ImuSample& sample : other_way) std::swap(sample.gyro_B, sample.accel_B);
  const CheckedImu imu{samples, check.exchanged ? other_way : good, check};
  say_steps(steps.imu, recorded, "sample", "imu", &out);
  if (const auto pressures = check_pressures(sensors.baro)) out.push_back(*pressures);
  if (worst(check.findings) != Verdict::kWrong) {
    out.push_back(check_start(imu, radars[0], options));
  }
  std::vector<Findings> of_radars;
  for (std::size_t r = 0; r < options.radars() && r < radars.size(); ++r) {
    const io::RadarInfo& info = r == 0 ? sensors.radar_info : sensors.other_radars[r - 1].info;
    of_radars.push_back(check_one_radar(imu, radars[r], steps.radars[r], info,
                                        {source, &info, r, radars.size() > 1}, options.seen_by(r),
                                        folder));
  }
  propose_edits_of_one_radar(&of_radars);
  for (std::size_t r = 0; r < of_radars.size(); ++r) {
    for (Finding& finding : of_radars[r]) {
      if (finding.subject == "gyro unit") {  // better than what the IMU alone shows
        std::erase_if(out, [](const Finding& f) { return f.subject == "gyro unit"; });
      }
      if (r > 0) finding.subject = fmt::format("radar{}: {}", r, finding.subject);
      out.push_back(std::move(finding));
    }
  }
  return out;
}

}  // namespace

Findings check_recording(const io::Dataset& dataset, const Options& options, Source source,
                         const std::filesystem::path& folder) {
  std::vector<Scans> radars;
  radars.emplace_back(dataset.scans);
  for (const io::Dataset::OtherRadar& other : dataset.other_radars) {
    radars.emplace_back(other.scans);
  }
  return check_all(dataset.imu, radars, dataset, options, source, folder);
}

Findings check_recording(const CheckedData& data, const Options& options, Source source,
                         const std::filesystem::path& folder) {
  return check_all(data.imu, data.radars, data.sensors, options, source, folder);
}

}  // namespace rio::check
