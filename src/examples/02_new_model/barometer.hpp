// SPDX-License-Identifier: BSD-3-Clause
// A barometer: air pressure, with what the sensor reads too much as a state of its own.
//
// (E1) p = p_0 (1 - L h / T_0)^(g M / (R L)) + b, the international standard atmosphere (ISO 2533),
//      h the height over the start, p_0 about the pressure there
#pragma once

#include <cmath>

#include <rio/models/aiding_measurement.hpp>

/// Excess of the reading [Pa]; 1 hPa of weather an hour.
struct PressureBias : rio::AuxiliaryBlock<1> {
  static constexpr const char* kName = "pressure_bias";
  static constexpr double kSigma = 50.0;
  static constexpr double kWalk = 1.7;
};

struct Barometer {
  static constexpr const char* kName = "barometer";
  static constexpr int kDim = 1;
  using Blocks = rio::BlockList<rio::BodyPose, PressureBias>;
  using Scalar = Eigen::Matrix<double, 1, 1>;
  struct Measurement {
    double pressure = 101325.0;  ///< [Pa]
    double sigma = 2.0;          ///< [Pa]
  };

  double p_0 = 101325.0;  ///< [Pa]

  bool evaluate(const Measurement& z, const rio::RigidPose& T_WB, const Scalar& bias, Scalar& r,
                Eigen::Matrix<double, 1, 7>* J, Scalar& R) const {
    constexpr double kLapse = 0.0065 / 288.15;  // L / T_0 [1/m]
    constexpr double kExponent = 5.25588;       // g M / (R L)
    const double base = 1.0 - kLapse * T_WB.p.z();
    if (base < 0.5) return false;  // beyond 20 km the lapse rate is another one
    const double pressure = p_0 * std::pow(base, kExponent);
    r[0] = z.pressure - pressure - bias[0];
    if (J != nullptr) {
      J->setZero();
      (*J)[5] = -kExponent * kLapse * pressure / base;  // the height
      (*J)[6] = 1.0;
    }
    R(0, 0) = z.sigma * z.sigma;
    return true;
  }
};
