// SPDX-License-Identifier: BSD-3-Clause
// Statistics of the filter of `default` on a recording, scan by scan: inliers of the consensus,
// innovations of the Doppler, matches and innovations of the landmarks, their lifetime.
//
// (E1) correlation from scan to scan: sum m_k m_k+1 / sum m_k^2, m_k the mean of innovation over
//      sigma of the Dopplers of a scan; zero if the residuals of consecutive scans are independent
// (E2) correlation of neighbours: mean of the products of innovation over sigma of two Dopplers of
//      a scan, from points within 4 deg and 1 m in range, over the mean of the squares; the part
//      not explained by the state's error is a common error
#pragma once

#include <vector>

#include "experiment/recording.hpp"
#include "rio/ekf/ekf.hpp"
#include "rio/io/dataset.hpp"

namespace rio::experiment {

/// NIS over degrees of freedom of the used rows, and the number of rejected blocks.
struct Innovations {
  double nis = 0.0;
  int dof = 0;
  int used = 0;   ///< blocks
  int gated = 0;  ///< blocks

  void add(const InnovationRecord& record);
  double mean_nis() const;     ///< NaN without values
  double gated_share() const;  ///< same
};

/// NaN if there is no data.
struct Testimony {
  int scans = 0;                  ///< processed, in motion
  double inlier_share = 0.0;      ///< of the points, inliers of the consensus
  double consensus = 0.0;         ///< share of the scans with a consensus
  Innovations doppler;            ///< in motion
  double doppler_rms = 0.0;       ///< of its innovations [m/s]
  double doppler_lag = 0.0;       ///< (E1)
  double neighbours = 0.0;        ///< (E2)
  double landmarks_a_scan = 0.0;  ///< matches used
  Innovations landmarks;
  Innovations found_again;         ///< of these, after a pause of a second
  double found_again_share = 0.0;  ///< of the matches
  double landmark_life = 0.0;      ///< median, from birth in motion to the last match used [s]
  int velocity_resets = 0;
};

/// The filter, with the birth and last use of its landmarks.
class Witness : public Ekf {
 public:
  using Ekf::Ekf;

  /// Whether the following scans count; landmarks count if born then.
  void listen(bool on) { listening_ = on; }
  Status update(const Observations& seen, UpdateReport* report);
  void maintain_landmarks(const Observations& seen, const Promotions& promotions,
                          UpdateReport* report);

  const Innovations& landmarks() const { return landmarks_; }
  const Innovations& found_again() const { return found_again_; }
  /// Lifetimes of the removed and of the present landmarks [s].
  std::vector<double> lives() const;

 private:
  struct Known {
    Vector3d p_W;
    Time born;
    bool counts;
    Time last_seen;
  };
  /// The current landmarks in the order of the estimate; missing ones have ended.
  void follow();

  bool listening_ = false;
  Innovations landmarks_;
  Innovations found_again_;
  std::vector<Known> known_;
  std::vector<double> ended_;
};

/// Static start and default options, except for the sensor properties of the recording.
/// @throws std::runtime_error if these options are invalid
Testimony testimony(const io::Dataset& data, const Motion& motion);

}  // namespace rio::experiment
