// SPDX-License-Identifier: BSD-3-Clause
// The configuration file (.cfg) of the demos of TI's mmWave SDK 3.x: what the radar will measure by
// it, and what is wrong with it for odometry. C++17. Allocates; for use before a flight.
//
//   const rio::ti::Config config = rio::ti::parse_config(text);
//   rio::ti::ConfigFigures figures;
//   if (rio::ti::derive(config, &figures, &why)) ...
//   for (const rio::ti::LintFinding& finding : rio::ti::lint(config, use)) ...
//
// Of the configurations with one frame (dfeDataOutputMode 1) and one profile; others are said not
// to be understood. Source: "mmWave SDK User's Guide" 3.x, chapter "Configuration (.cfg) File
// Format".
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rio/types.hpp"

namespace rio::ti {

/// One line of the file.
struct ConfigCommand {
  int line = 0;  ///< from 1
  std::string name;
  std::vector<std::string> arguments;

  /// Argument i as a number; NaN if there is none or it is none.
  double number(std::size_t i) const;
  /// Same, rounded towards zero; 0 for NaN.
  int whole(std::size_t i) const;
};

struct Config {
  std::vector<ConfigCommand> commands;  ///< in the order of the file, without comments (%, #)

  /// The n-th command of a name; null if there is none.
  const ConfigCommand* find(std::string_view name, std::size_t n = 0) const;
};

/// Splits the text into commands. Never fails: what makes no sense, lint() says.
Config parse_config(std::string_view text);

/// What a configuration makes of the radar. With Tl the time of a loop, the sum of idle time and
/// ramp over its chirps (one for each transmitter that takes turns), lambda the wavelength in the
/// middle of the samples, S the slope, fs the sampling rate, n the samples:
struct ConfigFigures {
  double max_speed = 0.0;   ///< lambda / (4 Tl): range rates fold beyond plus or minus it [m/s]
  double speed_grid = 0.0;  ///< 2 max_speed / Doppler bins, a power of two >= loops [m/s]
  double range_resolution = 0.0;  ///< c fs / (2 S n) [m]
  double range_grid = 0.0;        ///< c fs / (2 S range bins), a power of two >= n [m]
  double max_range = 0.0;         ///< 0.8 c fs / (2 S): 0.8 of the band of the samples [m]
  Time period{0};                 ///< of the frames
  Time chirp_block{0};            ///< loops x Tl
  int loops = 0;
  int chirps = 0;  ///< in a loop
  int samples = 0;
  int range_bins = 0;
  int doppler_bins = 0;
  int receivers = 0;
  int transmitters = 0;         ///< that some chirp of the frame uses
  bool side_info = false;       ///< SNR and noise of the points are sent
  double baud = 921600.0;       ///< of the data UART
  std::size_t fixed_bytes = 0;  ///< of a packet without points, and its padding
  std::size_t point_bytes = 0;  ///< of each point
  std::size_t cube_bytes = 0;   ///< radar cube and detection matrix in the L3 memory

  double frame_rate() const { return 1.0 / to_seconds(period); }
  /// Of the packet of a frame, padded [bytes].
  std::size_t packet_bytes(std::size_t points) const;
  /// On the wire, 10 bits a byte.
  Time packet_time(std::size_t points) const;
};

/// @param why what is missing or out of its range, if anything
/// @return the commands that the figures follow from are there and make sense
bool derive(const Config& config, ConfigFigures* figures, std::string* why = nullptr);

enum class LintKind : std::uint8_t {
  kUnknownCommand,      ///< the demo answers with an error
  kWrongArguments,      ///< their number, or one that is no number
  kMissingCommand,      ///< the demo refuses to start without it
  kWrongOrder,          ///< the demo refuses it there
  kClutterRemoval,      ///< on: deletes the world at rest
  kNoPoints,            ///< guiMonitor: detected points are not sent
  kNoSideInfo,          ///< guiMonitor: SNR and noise are not sent
  kTooSlow,             ///< the vehicle is faster than the unambiguous speed
  kCoarseSpeed,         ///< the grid of the speed is coarse
  kExtendedVelocity,    ///< on: right for single targets only
  kCfarTooHigh,         ///< hardly a point of a weak world at rest
  kUartTooSlow,         ///< the points of a frame do not get through
  kFrameTooShort,       ///< the chirps take longer than the period
  kSamplesOutsideRamp,  ///< sampling ends after the ramp
  kBandExceeded,        ///< the ramp leaves the band
  kInconsistent,        ///< profile, chirps, frame, channels contradict each other
  kTooMuchMemory,       ///< the radar cube does not fit
  kLvdsOn,              ///< raw data over LVDS, which nobody reads
  kHardwareTrigger,     ///< frames wait for a pulse
  kNarrowView,          ///< points are cut off by angle
  kSpeedCut,            ///< cfarFovCfg: points are cut off by speed
  kFlatElevation,       ///< the transmitters tell no elevation
  kCount
};
/// Name of a kind, as in "clutter removal".
const char* to_string(LintKind kind);

struct LintFinding {
  LintKind kind = LintKind::kCount;
  bool wrong = true;   ///< else doubtful
  int line = 0;        ///< 0: of no line
  std::string text;    ///< what is wrong, with numbers
  std::string change;  ///< what to write instead; may be empty
};

/// What the radar is for.
struct RadarUse {
  double speed = 5.0;       ///< of the vehicle at most [m/s]
  std::size_t points = 60;  ///< in a frame that must get through
  /// L3 memory for the radar cube: xWR18xx 1 MB; xWR68xx and xWR16xx 768 kB [bytes]
  std::size_t memory = std::size_t{1} << 20;
};

/// What is wrong with a configuration for odometry, in the order of the file, then what is missing.
std::vector<LintFinding> lint(const Config& config, const RadarUse& use = {});

/// The figures as options of this library (YAML), to be pasted.
std::string as_options(const ConfigFigures& figures);

}  // namespace rio::ti
