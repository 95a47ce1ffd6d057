// SPDX-License-Identifier: BSD-3-Clause
// The four figures that evo prints of a trajectory by default, and a record of them over flights
// and estimators. Nothing is aligned; a relative pose goes from one frame to the next.
//
// (E1) APE = RMSE of |p_est - p_true| and of the angle of R_est R_true^T
// (E2) RPE = RMSE of the same two of the steps T_i^-1 T_i+1
// Reference: M. Grupp, evo, 2017; Sturm et al., 2012.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "rio/eval/pairing.hpp"

namespace rio::experiment {

/// NaN if undefined.
struct PoseErrors {
  double ape = 0.0;        ///< (E1) [m]
  double ape_angle = 0.0;  ///< (E1) [deg]
  double rpe = 0.0;        ///< (E2) [m]
  double rpe_angle = 0.0;  ///< (E2) [deg]
};

/// @param pairs one per scan
PoseErrors pose_errors(const std::vector<eval::PosePair>& pairs);

/// One of the four, as in tables.
struct PoseErrorFigure {
  const char* name;
  int decimals;
  double PoseErrors::*value;
};
inline constexpr std::array kPoseErrors = {PoseErrorFigure{"APE [m]", 2, &PoseErrors::ape},
                                           PoseErrorFigure{"APE [deg]", 2, &PoseErrors::ape_angle},
                                           PoseErrorFigure{"RPE [m]", 4, &PoseErrors::rpe},
                                           PoseErrorFigure{"RPE [deg]", 3, &PoseErrors::rpe_angle}};

/// The errors of all runs.
class PoseErrorTable {
 public:
  struct Key {
    std::string group;
    std::string variant;
    bool operator<(const Key& other) const {
      return std::tie(group, variant) < std::tie(other.group, other.variant);
    }
  };

  void add(const Key& key, std::uint64_t seed, const PoseErrors& errors) {
    runs_[key][seed] = errors;
  }
  /// By increasing seed. @throws std::out_of_range if there is no such run
  std::vector<double> values(const Key& key, double PoseErrors::*value) const;
  /// Increase of a figure over another variant in the same flights: mean of the differences and its
  /// standard error, "+0.12 ± 0.03".
  std::string change(const Key& key, const std::string& reference,
                     const PoseErrorFigure& figure) const;
  /// A row per run.
  std::string as_csv() const;

 private:
  std::map<Key, std::map<std::uint64_t, PoseErrors>> runs_;  // by seed
};

}  // namespace rio::experiment
