// SPDX-License-Identifier: BSD-3-Clause
// Known point clouds, of drivers and of public data sets.
#pragma once

#include "rio/bag/point_fields.hpp"

namespace rio::bag {

/// A known source of clouds. It matches a cloud that has all its fields and none except those and
/// `others`, and whose fields with a scale are integers.
struct PointPreset {
  const char* name;
  const char* meaning;
  Axes axes;
  const char* fields;  ///< QUANTITY=FIELD[*SCALE], separated by blanks
  const char* others;
  bool recognised;
  const char* doubt = "";  ///< another source with the same fields
};

inline constexpr PointPreset kPointPresets[] = {
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

}  // namespace rio::bag
