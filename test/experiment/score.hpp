// SPDX-License-Identifier: BSD-3-Clause
// The figures of one trial. Estimate and truth share the world frame: nothing is aligned.
//
// APE = RMSE of |p_est - p_true| (M. Grupp, evo, 2017; Sturm et al., 2012).
#pragma once

#include <array>
#include <vector>

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
  double mae_at_127 = 0.0;     ///< norm of MAE over the first 127 m [m]
  double ape = 0.0;            ///< also the norm of RMSE of the position [m]
};
using Scores = std::vector<Score>;

Score score(const Trial& trial);

/// One figure of the score: its name in files.
struct Figure {
  const char* name;
  const char* unit;
  double Score::*value;
};

/// All numbers of a score, in the order of the files.
inline constexpr std::array kFigures = {
    Figure{"path", "m", &Score::path_length},
    Figure{"final_error", "m", &Score::final_error},
    Figure{"drift", "%", &Score::drift},
    Figure{"mae", "m", &Score::mae},
    Figure{"heading", "deg", &Score::heading},
    Figure{"velocity", "m/s", &Score::velocity},
    Figure{"nees_position", "", &Score::nees_position},
    Figure{"nees_attitude", "", &Score::nees_attitude},
    Figure{"nees_heading", "", &Score::nees_heading},
    Figure{"nees_velocity", "", &Score::nees_velocity},
    Figure{"nis_doppler", "", &Score::nis_doppler},
    Figure{"nis_trails", "", &Score::nis_trails},
    Figure{"nis_landmarks", "", &Score::nis_landmarks},
    Figure{"nis_points", "", &Score::nis_points},
    Figure{"nis_positions", "", &Score::nis_positions},
    Figure{"mae_at_127", "m", &Score::mae_at_127},
    Figure{"ape", "m", &Score::ape},
};

}  // namespace rio::experiment
