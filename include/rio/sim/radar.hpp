// SPDX-License-Identifier: BSD-3-Clause
// Simulated FMCW radar: reflectors, walls and people to the labelled detections of one scan.
//
// (E2) v_S = R_SB (R_BW v_WB + w_B x p_BS), the radar's own velocity
// (E3) range rate of a point in direction u that moves with v: -u . (v_S - v) (positive = receding)
// (E4) SNR = snr_1m + rcs - 40 log10 r - edge_loss ((2 az / fov_az)^2 + (2 el / fov_el)^2) + fading
// (E5) noise: r + sigma_r n, az + g sigma_az / cos(az) n, el + g sigma_el / cos(el) n, Doppler +
//      sigma_d n, sigmas at the true direction; then the grids, and folding into [-v_max, v_max)
// (E6) weak echoes: g^2 = 1 + k 10^(-(SNR - threshold) / 10)
// (E7) n = sqrt(1 - f^2) n_lasting + f n_fresh; interference lasts while the radar is at rest
// (E8) a directional reflector: 3 dB (aspect / lobe_width)^2 less at an aspect off its facing
// (E9) azimuth and elevation of all points are off by e <- k e + sqrt(1 - k^2) scene_angle n,
//      k = exp(-way / scene_distance), first order in the distance travelled
// One peak per range-Doppler cell. Frames W, B, S; metres, radians, m/s, dB.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "rio/sim/fading.hpp"
#include "rio/sim/people.hpp"
#include "rio/sim/radar_model.hpp"
#include "rio/sim/random.hpp"
#include "rio/sim/room.hpp"
#include "rio/sim/specular.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// The radar in its room, one call per scan.
class RadarSimulator {
 public:
  RadarSimulator(RadarModel model, Room room, std::uint64_t seed);

  /// The scan of the radar mounted on `body`, with the model's share of outliers.
  LabeledScan scan(const Trajectory::Point& body) { return scan(body, model_.outlier_share); }
  /// The same with another share of outliers, as in a burst.
  LabeledScan scan(const Trajectory::Point& body, double outlier_share);

  const Room& room() const { return room_; }

 private:
  /// The radar's pose and velocity.
  struct View {
    Matrix3d R_SW;
    Vector3d p_WS;
    Vector3d v_S;

    Vector3d to_S(const Vector3d& point_W) const { return R_SW * (point_W - p_WS); }
  };
  /// An echo at the antenna, free of noise.
  struct Echo {
    Polar polar;
    double range_rate = 0.0;
    double snr_db = 0.0;
    Label label;
    Speckle::Noise lasting = Speckle::Noise::Zero();  ///< (E7)
  };
  using Cell = std::pair<long, long>;

  bool visible(const Vector3d& point_S) const;

  /// A point with velocity `velocity_S` relative to the radar, (E3).
  static Echo echo_of(const Vector3d& point_S, const Vector3d& velocity_S, Label label);

  /// Keeps the echo if it passes the threshold.
  void receive(Echo echo, double rcs_dbsm, const Speckle& speckle, std::vector<Echo>& echoes);

  /// (E8) [dB]
  double aspect_loss(const View& view, std::size_t reflector) const;

  void add_reflectors(const View& view, std::vector<Echo>& echoes);

  void add_highlights(const View& view, std::vector<Echo>& echoes);

  void add_people(const View& view, double seconds, std::vector<Echo>& echoes);

  /// The visible echoes of the vehicle itself.
  void add_own(std::vector<Echo>& echoes);

  /// The strongest echo of each range-Doppler cell, strongest first; at most `max_static` static
  /// ones.
  std::vector<Echo> peaks(std::vector<Echo> echoes) const;

  /// Bin of the range and of the Doppler; the latter wraps.
  Cell cell(double range, double range_rate) const;

  /// As many outliers as the share requires; ghosts come from the reflectors most prone to them.
  void add_outliers(const View& view, double share, std::vector<Echo>& echoes);

  const Reflector& reflector(const Echo& echo) const {
    return room_.reflectors[static_cast<std::size_t>(echo.label.reflector)];
  }

  Echo false_alarm();

  /// The nearest mirror image in view, or the double bounce, or a false alarm if neither exists.
  Echo ghost(const Echo& source, const View& view);

  /// (E9) after another piece of the way [m].
  void age_scene(double way);

  /// (E5)
  RadarDetection measure(const Echo& echo);

  RadarModel model_;
  Room room_;
  Random radar_random_;
  Fading fading_;
  double cos_half_azimuth_;
  double sin_half_elevation_;
  Highlights highlights_;
  Speckles reflector_speckles_;
  Speckles highlight_speckles_;
  Random own_random_;
  std::vector<Polar> own_;          ///< positions of the echoes of the vehicle
  std::vector<Vector3d> facing_W_;  ///< one per reflector, if they have lobes
  std::vector<Person> people_;
  std::vector<Speckles> people_speckles_;
  Random scene_random_;
  Eigen::Vector2d scene_error_ = Eigen::Vector2d::Zero();  ///< of azimuth and elevation [rad]
  std::optional<Time> first_scan_;
  Vector3d last_p_WS_ = Vector3d::Zero();
  double path_ = 0.0;
};

}  // namespace rio::sim
