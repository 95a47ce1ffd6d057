// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bitset>
#include <cmath>

#include "config_commands.hpp"

namespace rio::ti {
namespace {

constexpr double kCoarseGrid = 0.25;      // [m/s]
constexpr double kLongestPeriod = 100.0;  // [ms]

std::string number(double value) {
  return format("%g", value);
}

class FigureCheck : private ConfigCheck {
 public:
  FigureCheck(const Config& in_force, const ConfigFigures& figures, const RadarUse& use,
              std::vector<LintFinding>* findings)
      : ConfigCheck(in_force, findings),
        figures_(figures),
        use_(use),
        profile_(used_profile(in_force)) {}

  void run() {
    check_profile();
    check_chirps();
    check_speed();
    check_time();
    check_memory();
  }

 private:
  void check_profile() {
    const ConfigCommand& p = *profile_;
    const double start = p.number(1), adc_start = p.number(3), ramp = p.number(4);
    const double slope = p.number(7), sampling = 1e3 * p.number(9) / p.number(10);
    if (adc_start + sampling > ramp) {
      add(LintKind::kSamplesOutsideRamp, true, &p,
          format("the samples end %.2f us after the start of the ramp, which ends after %g us",
                 adc_start + sampling, ramp),
          line_of(p, 4, number(std::ceil(adc_start + sampling + 1.0))));
    }
    const bool high = is_high_band();
    const double low_edge = high ? 76.0 : 60.0, high_edge = high ? 81.0 : 64.0;
    const double end = start + 1e-3 * slope * ramp;
    if (start < low_edge || end > high_edge) {
      const double fitting = 1e3 * (high_edge - std::max(start, low_edge)) / ramp;
      add(LintKind::kBandExceeded, true, &p,
          format("the ramp goes from %g to %.3f GHz, the band from %g to %g GHz", start, end,
                 low_edge, high_edge),
          line_of(p, 7, number(std::floor(10.0 * std::min(slope, fitting)) / 10.0)));
    }
    each("profileCfg", [&](const ConfigCommand& c) {
      if (c.number(0) == p.number(0)) return;
      add(LintKind::kInconsistent, true, &c,
          format("another profile than %g, that of the first chirp: the figures are those of one",
                 p.number(0)),
          "take the line out");
    });
  }

  /// Checks that each chirp of the frame is defined once, by the profile, with one enabled
  /// transmitter, or with two at once by BPM.
  void check_chirps() {
    const ConfigCommand& frame = *config_.find("frameCfg");
    const int on = config_.find("channelCfg")->whole(1);
    for (int chirp = frame.whole(0); chirp <= frame.number(1); ++chirp) {
      int found = 0;
      each("chirpCfg", [&](const ConfigCommand& c) {
        if (!(c.number(0) <= chirp && chirp <= c.number(1))) return;
        ++found;
        check_chirp(c, on);
      });
      if (found == 1) continue;
      add(LintKind::kInconsistent, true, &frame,
          format("chirp %d of the frame is defined %d times", chirp, found), "");
    }
    if (figures_.transmitters < 3) {
      add(LintKind::kFlatElevation, false, &frame,
          format("%d transmitters take turns: an xWR1843BOOST tells no elevation by them",
                 figures_.transmitters),
          "chirps 0, 1, 2 with the transmitters 1, 4, 2, and frameCfg 0 2 ...");
    }
  }

  void check_chirp(const ConfigCommand& c, int on) {
    if (c.number(2) != profile_->number(0)) {
      add(LintKind::kInconsistent, true, &c,
          format("the chirp uses profile %g, not %g, for which the figures are", c.number(2),
                 profile_->number(0)),
          line_of(c, 2, profile_->arguments[0]));
    }
    const int mask = c.whole(7);
    if (mask == 0 || (mask & ~on) != 0) {
      add(LintKind::kInconsistent, true, &c,
          format("the chirp uses transmitters %d, channelCfg switches on %d", mask, on), "");
    }
    const auto at_once = std::bitset<32>(static_cast<unsigned>(mask)).count();
    const ConfigCommand* bpm = config_.find("bpmCfg");
    const bool is_bpm = bpm != nullptr && bpm->number(1) == 1.0;
    if (mask == 0 || at_once == (is_bpm ? 2U : 1U)) return;
    add(LintKind::kInconsistent, true, &c,
        format("the chirp uses %zu transmitters at once: %s", at_once,
               is_bpm ? "bpmCfg is on, it needs two" : "without bpmCfg they must take turns"),
        is_bpm ? line_of(*bpm, 1, "0") : "one of the transmitters 1, 2, 4 in each chirp");
  }

  void check_speed() {
    if (figures_.max_speed < use_.speed) {
      const double share = figures_.max_speed / use_.speed;
      add(LintKind::kTooSlow, true, profile_,
          format("Dopplers fold at +-%.2f m/s, the vehicle flies %g m/s", figures_.max_speed,
                 use_.speed),
          format("a loop of %d chirps must take %.0f us instead of %.0f: shorter idle time and "
                 "ramp, or fewer chirps",
                 figures_.chirps, std::floor(1e6 * share * loop_time()), 1e6 * loop_time()));
    }
    if (figures_.speed_grid > kCoarseGrid) {
      add(LintKind::kCoarseSpeed, false, config_.find("frameCfg"),
          format("the grid of the Doppler is %.2f m/s", figures_.speed_grid),
          format("more than %d loops", figures_.loops));
    }
    each("cfarFovCfg", [&](const ConfigCommand& c) {
      if (c.number(1) != 1.0) return;
      const double least = std::min(use_.speed, figures_.max_speed - figures_.speed_grid);
      if (c.number(2) <= -least && c.number(3) >= least) return;
      add(LintKind::kSpeedCut, true, &c,
          format("Dopplers beyond %g to %g m/s are cut off, the vehicle flies %g m/s", c.number(2),
                 c.number(3), use_.speed),
          format("cfarFovCfg -1 1 %.2f %.2f", -figures_.max_speed, figures_.max_speed));
    });
  }

  double loop_time() const { return to_seconds(figures_.chirp_block) / figures_.loops; }

  void check_time() {
    const ConfigCommand& frame = *config_.find("frameCfg");
    const double period = 1e3 * to_seconds(figures_.period);  // [ms]
    const double block = 1e3 * to_seconds(figures_.chirp_block);
    const double wire = 1e3 * to_seconds(figures_.packet_time(use_.points));
    if (block >= period) {
      add(LintKind::kFrameTooShort, true, &frame,
          format("the chirps take %.2f ms of a period of %g ms", block, period),
          line_of(frame, 4, number(std::ceil(block / 0.5))));
      return;
    }
    if (period > kLongestPeriod) {
      add(LintKind::kFewScans, false, &frame,
          format("a scan each %g ms: ten a second or more confirm each other", period),
          line_of(frame, 4, number(kLongestPeriod)));
    }
    if (wire < period - block) return;
    const double free = 1e-4 * (period - block) * figures_.baud;  // [bytes]
    const double room = free - static_cast<double>(figures_.fixed_bytes) - 31.0;
    const double fit = room > 0.0 && figures_.point_bytes > 0
                           ? std::floor(room / static_cast<double>(figures_.point_bytes))
                           : 0.0;
    const ConfigCommand* gui = config_.find("guiMonitor");
    add(LintKind::kUartTooSlow, wire >= period, gui == nullptr ? &frame : gui,
        format("a packet of %zu points has %zu bytes and takes %.1f ms at %.0f baud; the chirps "
               "leave %.1f ms of %g, enough for %.0f points",
               use_.points, figures_.packet_bytes(use_.points), wire, figures_.baud, period - block,
               period, fit),
        "guiMonitor -1 1 0 0 0 0 0, a longer period, or a faster configDataPort");
  }

  bool is_high_band() const { return profile_->number(1) >= 70.0; }

  void check_memory() {
    const std::size_t of_device = std::size_t{is_high_band() ? 1024U : 768U} * 1024;
    const std::size_t memory = use_.memory > 0 ? use_.memory : of_device;
    if (figures_.cube_bytes <= memory) return;
    add(LintKind::kTooMuchMemory, true, config_.find("frameCfg"),
        format("the radar cube of %d range bins, %d loops, %d chirps and %d receivers has %zu kB, "
               "the memory %zu kB",
               figures_.range_bins, figures_.loops, figures_.chirps, figures_.receivers,
               figures_.cube_bytes / 1024, memory / 1024),
        "half the samples, or half the loops");
  }

  const ConfigFigures& figures_;
  const RadarUse& use_;
  const ConfigCommand* profile_;  ///< for which they are
};

}  // namespace

void check_figures(const Config& in_force, const ConfigFigures& figures, const RadarUse& use,
                   std::vector<LintFinding>* findings) {
  FigureCheck(in_force, figures, use, findings).run();
}

}  // namespace rio::ti
