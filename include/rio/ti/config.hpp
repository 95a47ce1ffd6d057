// SPDX-License-Identifier: BSD-3-Clause
// The configuration file (.cfg) of the demos of TI's mmWave SDK 3.x: the resulting figures of the
// radar, and the errors for odometry. C++17. Allocates; for use before a flight.
//
//   const rio::ti::Config config = rio::ti::parse_config(text);
//   rio::ti::ConfigFigures figures;
//   if (rio::ti::derive(config, &figures, &why)) ...
//   for (const rio::ti::LintFinding& finding : rio::ti::lint(config, use)) ...
//
// Supported are configurations with one frame (dfeDataOutputMode 1) and one profile; others are
// reported as not understood. Source: "mmWave SDK User's Guide" 3.x, chapter "Configuration (.cfg)
// File Format".
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rio/ti/firmware.hpp"
#include "rio/types.hpp"

namespace rio::ti {

/// One line of the file.
struct ConfigCommand {
  int line = 0;  ///< from 1
  std::string name;
  std::vector<std::string> arguments;

  /// Argument i as a number; NaN if it is missing or not a number.
  double number(std::size_t i) const;
  /// Same, rounded towards zero; 0 for NaN.
  int whole(std::size_t i) const;
};

struct Config {
  std::vector<ConfigCommand> commands;  ///< in the order of the file, without comments (%, #)

  /// The n-th command of a name; null if there is none.
  const ConfigCommand* find(std::string_view name, std::size_t n = 0) const;
};

/// Splits the text into commands, without a mark of UTF-8; its lines end in LF, CR LF or CR. Never
/// fails: lint() reports invalid commands.
Config parse_config(std::string_view text);

/// Figures of the radar with a configuration. Tl is the time of a loop, the sum of idle time and
/// ramp over its chirps (one for each transmitter in turn), lambda the wavelength in the middle of
/// the samples, S the slope, fs the sampling rate, n the number of samples:
struct ConfigFigures {
  double max_speed = 0.0;   ///< lambda / (4 Tl): range rates fold beyond plus or minus it [m/s]
  double speed_grid = 0.0;  ///< 2 max_speed / Doppler bins, a power of two >= loops [m/s]
  double range_resolution = 0.0;  ///< c fs / (2 S n) [m]
  double range_grid = 0.0;        ///< c fs / (2 S range bins), a power of two >= n [m]
  /// 0.8 c fs / (2 S): 0.8 of the band of the samples; half of it if they show the image band, too
  /// (complex 2x, adcCfg 2 2) [m]
  double max_range = 0.0;
  Time period{0};       ///< of the frames
  Time chirp_block{0};  ///< loops x Tl
  int loops = 0;
  int chirps = 0;  ///< per loop
  int samples = 0;
  int range_bins = 0;
  int doppler_bins = 0;
  int receivers = 0;
  int transmitters = 0;         ///< used by some chirp of the frame, at most as many as chirps
  bool side_info = false;       ///< SNR and noise of the points are sent
  double baud = 921600.0;       ///< of the data UART
  std::size_t fixed_bytes = 0;  ///< of a packet, without points and padding
  std::size_t point_bytes = 0;  ///< of each point
  std::size_t cube_bytes = 0;   ///< radar cube and detection matrix in the L3 memory

  double frame_rate() const { return 1.0 / to_seconds(period); }
  /// Of the packet of a frame, padded [bytes].
  std::size_t packet_bytes(std::size_t points) const;
  /// On the wire, 10 bits a byte.
  Time packet_time(std::size_t points) const;
};

/// Row of firmware.hpp, by its commands; null for the demo of SDK 3.x.
const Firmware* other_firmware(const Config& config);

/// @param why what is missing or out of range, or whose configuration it is, if anything
/// @return the commands needed for the figures are present and valid, and of the demo of SDK 3.x
bool derive(const Config& config, ConfigFigures* figures, std::string* why = nullptr);

enum class LintKind : std::uint8_t {
  kUnknownCommand,      ///< the demo answers with an error
  kWrongArguments,      ///< wrong number of arguments, or one that is not a number
  kMissingCommand,      ///< the demo refuses to start without it
  kWrongOrder,          ///< the demo refuses the command in this place
  kClutterRemoval,      ///< on: removes static reflectors
  kNoPoints,            ///< guiMonitor: detected points are not sent
  kNoSideInfo,          ///< guiMonitor: SNR and noise are not sent
  kTooSlow,             ///< the vehicle is faster than the unambiguous speed
  kCoarseSpeed,         ///< the grid of the speed is coarse
  kExtendedVelocity,    ///< on: valid for single targets only
  kCfarTooHigh,         ///< too few points of weak static reflectors
  kUartTooSlow,         ///< the points of a frame exceed the bandwidth
  kFrameTooShort,       ///< the chirps take longer than the period
  kSamplesOutsideRamp,  ///< sampling ends after the ramp
  kBandExceeded,        ///< the ramp leaves the band
  kInconsistent,        ///< profile, chirps, frame, channels contradict each other
  kTooMuchMemory,       ///< the radar cube does not fit
  kLvdsOn,              ///< raw data over LVDS, which is unused
  kHardwareTrigger,     ///< frames wait for a pulse
  kNarrowView,          ///< points are rejected by angle
  kSpeedCut,            ///< cfarFovCfg: points are rejected by speed
  kFlatElevation,       ///< the transmitters do not resolve elevation
  kOtherFirmware,       ///< not of the demo of SDK 3.x: nothing but the clutter removal was judged
  kFewScans,            ///< fewer than ten a second
  kCount
};
/// Name of a kind, as in "clutter removal".
const char* to_string(LintKind kind);

struct LintFinding {
  LintKind kind = LintKind::kCount;
  bool wrong = true;   ///< else doubtful
  int line = 0;        ///< 0: not of a line
  std::string text;    ///< the problem, with numbers
  std::string change;  ///< the line to write instead; may be empty
};

/// Intended use of the radar.
struct RadarUse {
  double speed = 5.0;       ///< maximum of the vehicle [m/s]
  std::size_t points = 60;  ///< per frame, to be transmitted
  /// L3 memory for the radar cube [bytes]. 0: by the band, 768 kB at 60 GHz (xWR68xx) and 1 MB at
  /// 77 GHz (xWR18xx; the xWR16xx has 768 kB)
  std::size_t memory = 0;
};

/// Errors of a configuration for odometry, in the order of the file, then missing commands. A line
/// with a wrong number of arguments is not judged further.
std::vector<LintFinding> lint(const Config& config, const RadarUse& use = {});

/// The figures as options of this library (YAML), to paste.
std::string as_options(const ConfigFigures& figures);

}  // namespace rio::ti
