// SPDX-License-Identifier: BSD-3-Clause
// The firmware of TI's mmWave radars whose packets are told apart, and which of them is read.
// C++17.
//
// Sources: mmw_output.h and dpif_pointcloud.h of the mmWave SDK 3.x, mmw_output.h of the MCU+ SDK
// and of the SDK for low-power radars, the TLV definitions and visualizers of TI's Radar Toolbox
// and Industrial Toolbox, the MRR and SRR demos of SDK 1 to 3, people tracking of the
// xWRL6844.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rio::ti {

/// Layout of a point; in packet.hpp.
enum class PointForm : std::uint8_t {
  kNotRead,
  kCartesian,       ///< 4 f32: x, y, z, Doppler
  kCartesianUnits,  ///< i16 x, y, z, Doppler times units; SNR, noise of 1 or 2 bytes
  kSpherical,       ///< 4 f32: range, azimuth, elevation, Doppler
  kSphericalUnits,  ///< i8 elevation, azimuth, i16 Doppler, u16 range, SNR times units
};

struct Firmware {
  const char* name;
  std::uint32_t first_sdk;  ///< major version in the header
  std::uint32_t last_sdk;
  std::size_t header;  ///< of the packet [bytes]
  std::uint32_t tlv;   ///< type of the TLV with the points
  std::size_t head;    ///< of its payload, in front of the points [bytes]
  std::size_t point;   ///< each [bytes]
  PointForm form;
  int baud;            ///< usual rate of the data port
  const char* advice;  ///< what to load if it is not read; else empty
  /// Of its configuration, each between blanks: commands that SDK 3.x does not know.
  const char* commands = "";
};

/// The first row that fits a packet is its firmware: version, header, TLV, and a payload of whole
/// points. The last row of a header is for all others with it. In TLV 1 of SDK 3 and 4, which other
/// demos fill with objects of other sizes, numDetectedObj must be the number of the points;
/// elsewhere that is 0, or of some of them (major motion), in some firmware.
inline constexpr Firmware kFirmware[] = {
    {"SDK 1 or 2", 0, 2, 40, 1, 4, 12, PointForm::kNotRead, 921600, "load a demo of SDK 3.x",
     " peakGrouping nearFieldCfg "},
    {"SDK 3.x", 3, 3, 40, 1, 0, 16, PointForm::kCartesian, 921600, ""},
    {"AWR2944, AWR2944P (MCU+ SDK 4.x)", 4, 4, 40, 1, 0, 16, PointForm::kCartesian, 3125000, "",
     " ddmPhaseShiftAntOrder compressionCfg intfMitigCfg localMaxCfg procChainCfg rangeProcCfg "
     "antennaCalibParams "},
    {"xWRL6432, xWRL1432, xWRL6844 (SDK 5 or later)", 5, 255, 40, 1, 0, 16, PointForm::kCartesian,
     1250000, "",
     " chirpComnCfg chirpTimingCfg sigProcChainCfg factoryCalibCfg adcDataSource lowPowerCfg "},
    {"xWRL6432 (compressed points)", 3, 255, 40, 301, 20, 10, PointForm::kCartesianUnits, 1250000,
     ""},
    {"xWRL6432 (compressed points)", 3, 255, 40, 301, 20, 12, PointForm::kCartesianUnits, 1250000,
     ""},
    {"people counting or tracking", 3, 255, 40, 1020, 20, 8, PointForm::kSphericalUnits, 921600, "",
     " trackingCfg allocationParam gatingParam stateParam sceneryParam SceneryParam variationParam "
     "boundaryBox staticBoundaryBox presenceBoundaryBox dynamicRACfarCfg staticRACfarCfg "
     "dynamicRangeAngleCfg dynamic2DAngleCfg staticRangeAngleCfg doaCfg maxAcceleration "
     "vitalSignsCfg "},
    {"TI's toolbox (spherical points)", 3, 255, 40, 1000, 0, 16, PointForm::kSpherical, 921600, ""},
    {"MRR or SRR (objects of 10 bytes)", 3, 255, 40, 1, 4, 10, PointForm::kNotRead, 921600,
     "load the out-of-box demo of SDK 3.x"},
    {"MRR or SRR (objects of 14 bytes)", 3, 255, 40, 1, 4, 14, PointForm::kNotRead, 921600,
     "load the out-of-box demo of SDK 3.x"},
    {"SRR (objects of 8 bytes)", 3, 255, 40, 1, 4, 8, PointForm::kNotRead, 921600,
     "load the out-of-box demo of SDK 3.x"},
    {"an unknown demo", 3, 255, 40, 0, 0, 0, PointForm::kNotRead, 921600,
     "load the out-of-box demo of SDK 3.x"},
    {"area scanner (header of 44 bytes)", 0, 4, 44, 1, 0, 16, PointForm::kNotRead, 921600,
     "load the out-of-box demo of SDK 3.x"},
    {"xWRL6844 people tracking (header of 44 bytes)", 5, 255, 44, 1, 0, 16, PointForm::kNotRead,
     1250000, "load the out-of-box demo of its SDK"},
    {"people counting (header of 48 bytes)", 0, 255, 48, 6, 20, 8, PointForm::kNotRead, 921600,
     "load the out-of-box demo of SDK 3.x"},
    {"people counting (header of 52 bytes)", 0, 255, 52, 6, 0, 16, PointForm::kNotRead, 921600,
     "load the out-of-box demo of SDK 3.x"},
};
inline constexpr const Firmware& kOldDemos = kFirmware[0];
inline constexpr const Firmware& kDemo = kFirmware[1];
inline constexpr const Firmware& kUnknownDemo = kFirmware[11];
static_assert(kUnknownDemo.header == 40 && kUnknownDemo.point == 0);

}  // namespace rio::ti
