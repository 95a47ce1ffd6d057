// SPDX-License-Identifier: BSD-3-Clause
// The figures of one trial. Estimate and truth share the world frame: nothing is aligned.
#pragma once

#include <array>

#include "experiment/trial.hpp"

namespace rio::experiment {

/// Figures of a trial; NaN if undefined.
struct Score {
  bool complete = false;       ///< see Trial
  bool lost = false;           ///< not complete, or final error above 5 % of the path and 2 m
  double path_length = 0.0;    ///< of the truth [m]
  double final_error = 0.0;    ///< distance at the last scan [m]
  double drift = 0.0;          ///< the same in percent of the path
  double mae = 0.0;            ///< norm of MAE of the position [m]
  double heading = 0.0;        ///< RMSE of the heading [deg]
  double velocity = 0.0;       ///< RMSE of the velocity [m/s]
  double nees_position = 0.0;  ///< mean over the scans of NEES over its dimension; 1 is consistent
  double nees_attitude = 0.0;  ///< same
  double nees_heading = 0.0;   ///< same
  double nees_velocity = 0.0;  ///< same
  double nis_doppler = 0.0;    ///< mean normalised innovation squared of the rows used
  double nis_trails = 0.0;     ///< same
  double nis_points = 0.0;     ///< same, landmarks measured as points
  double nis_positions = 0.0;  ///< same, landmarks measured as positions
  double nis_landmarks = 0.0;  ///< same, ranges
};

Score score(const Trial& trial);

/// One figure of the score: its name in tables and files.
struct Figure {
  const char* name;
  const char* unit;
  int decimals;
  double Score::*value;
};

/// All numbers of a score, in the order of the files.
inline constexpr std::array kFigures = {
    Figure{"path", "m", 1, &Score::path_length},
    Figure{"final_error", "m", 3, &Score::final_error},
    Figure{"drift", "%", 3, &Score::drift},
    Figure{"mae", "m", 3, &Score::mae},
    Figure{"heading", "deg", 2, &Score::heading},
    Figure{"velocity", "m/s", 3, &Score::velocity},
    Figure{"nees_position", "", 2, &Score::nees_position},
    Figure{"nees_attitude", "", 2, &Score::nees_attitude},
    Figure{"nees_heading", "", 2, &Score::nees_heading},
    Figure{"nees_velocity", "", 2, &Score::nees_velocity},
    Figure{"nis_doppler", "", 3, &Score::nis_doppler},
    Figure{"nis_trails", "", 3, &Score::nis_trails},
    Figure{"nis_landmarks", "", 3, &Score::nis_landmarks},
    Figure{"nis_points", "", 3, &Score::nis_points},
    Figure{"nis_positions", "", 3, &Score::nis_positions},
};

}  // namespace rio::experiment
