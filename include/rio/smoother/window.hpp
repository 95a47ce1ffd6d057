// SPDX-License-Identifier: BSD-3-Clause
// The sliding window: a state at each of the last scans with its measurements, each a factor, and
// the IMU factor to the next state. Storage is allocated once.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rio/options.hpp"
#include "rio/smoother/imu_factor.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/aiding.hpp"
#include "rio/update/scan_measurements.hpp"

namespace rio {

/// A measurement of another sensor, taken between the previous state and this one.
struct AidingFactor {
  AidingMeasurement measurement;
  ImuIncrements since;
};

/// A state of the window with its factors and measurements.
struct WindowState {
  ScanId scan = kNoScan;
  NavState nav;
  Vector3d gyro_B = Vector3d::Zero();   ///< measured [rad/s]
  double gyro_variance = 0.0;           ///< of that, per axis [rad^2/s^2]
  SteadyMotion steady;                  ///< as predicted; of its acceleration the next entry counts
  Vector3d accel_B = Vector3d::Zero();  ///< acceleration of the body, body axes [m/s^2]
  /// The calibration that was applied to a radar's scan of this state.
  struct Scanned {
    bool here = false;           ///< the radar has a scan here
    double time_offset = 0.0;    ///< stamp minus time of the state [s]
    double doppler_scale = 0.0;  ///< detections corrected by this
  };
  std::array<Scanned, kMaxRadars> scanned;
  ImuFactor to_next;                 ///< not valid for the newest state
  ScanMeasurements measurements;     ///< of the scans
  std::vector<AidingFactor> aiding;  ///< of other sensors

  bool at_rest() const { return !measurements.of<RestModel>().empty(); }

  /// State of the scans, to undo additions.
  struct Mark {
    ScanMeasurements::Sizes measurements;
    std::array<Scanned, kMaxRadars> scanned;
  };
  Mark mark() const { return {measurements.sizes(), scanned}; }
  /// Removes what was added after mark(), except aiding.
  void cut(const Mark& mark) {
    measurements.cut(mark.measurements);
    scanned = mark.scanned;
  }

  void clear();
};

/// Ring of states; index 0 is the oldest.
class Window {
 public:
  Window(std::size_t capacity, const Options& options);

  std::size_t size() const { return size_; }
  WindowState& operator[](std::size_t i) { return slots_[(first_ + i) % slots_.size()]; }
  const WindowState& operator[](std::size_t i) const {
    return slots_[(first_ + i) % slots_.size()];
  }
  WindowState& newest() { return (*this)[size_ - 1]; }
  const WindowState& newest() const { return (*this)[size_ - 1]; }

  void clear() { size_ = 0; }
  /// Appends an empty state, the new newest one.
  WindowState& push();
  void pop_oldest() {
    first_ = (first_ + 1) % slots_.size();
    --size_;
  }
  void pop_newest() { --size_; }

  /// Index of the first state not before `time`, size() if there is none.
  std::size_t first_from(Time time) const;

  /// Index of the state of `scan`, or -1.
  int find(ScanId scan) const;

  /// Copies its poses to the clones of x, for matching and for the trails.
  void publish(Estimate* x) const;

  /// A state has a factor of landmark i.
  bool measures_landmark(std::size_t i) const;

  /// Removes the factors of landmark i; those of the last landmark are renumbered to i.
  void forget_landmark(std::size_t i, std::size_t last) {
    for (std::size_t k = 0; k < size_; ++k) (*this)[k].measurements.forget_landmark(i, last);
  }

 private:
  std::vector<WindowState> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

/// Columns of [states | border] for the models.
struct WindowLayout {
  Layout newest;   ///< [newest state | border] without clones, of the radar that measures
  int states = 0;  ///< number of states
  int state = 0;   ///< the one that measures

  int border_column() const { return body::kSize * states; }

  template <class Block>
  int column(int index) const {
    if constexpr (std::is_same_v<Block, ClonePose>) return body::kSize * index + body::kAttitude;
    return shifted(newest.column<Block>(index));
  }
  int time_offset_column() const { return shifted(newest.time_offset_column()); }
  int auxiliary() const { return shifted(newest.auxiliary()); }

 private:
  /// For a column of [newest state | border].
  int shifted(int column) const {
    if (column < 0) return -1;
    return column + (column < body::kSize ? body::kSize * state : border_column() - body::kSize);
  }
};

}  // namespace rio
