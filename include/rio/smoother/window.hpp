// SPDX-License-Identifier: BSD-3-Clause
// The sliding window: a state at each of the last scans, what that scan measured, and the IMU to
// the next one. Storage for all of it is allocated once.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "rio/models/doppler.hpp"
#include "rio/models/landmark_distance.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/models/landmark_position.hpp"
#include "rio/models/rest.hpp"
#include "rio/models/trail_distance.hpp"
#include "rio/options.hpp"
#include "rio/smoother/imu_factor.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/aiding.hpp"

namespace rio {

/// A Doppler; here and below, `weight` is the share of its information that is new.
struct DopplerFactor {
  DopplerModel::Measurement doppler;
  double weight = 1.0;
  std::size_t radar = 0;
};
/// A detection of a landmark.
struct PointFactor {
  std::size_t landmark = 0;
  double weight = 1.0;
  LandmarkPointModel::Measurement point;
  std::optional<LandmarkDopplerModel::Measurement> doppler;
  std::size_t radar = 0;
};
/// A range to a landmark.
struct DistanceFactor {
  std::size_t landmark = 0;
  double weight = 1.0;
  LandmarkDistanceModel::Measurement distance;
  std::size_t radar = 0;
};
/// The place of a landmark.
struct PositionFactor {
  std::size_t landmark = 0;
  double weight = 1.0;
  LandmarkPositionModel::Measurement position;
  std::size_t radar = 0;
};
/// A range to a point detected at a past scan of the window.
struct TrailFactor {
  ScanId past = 0;
  TrailDistanceModel::Measurement distance;
  std::size_t radar = 0;
};

/// Of another sensor, between the state before and this one.
struct AidingFactor {
  AidingMeasurement measurement;
  MotionSince since;
};

struct WindowState {
  ScanId scan = kNoScan;
  NavState nav;
  Vector3d gyro_B = Vector3d::Zero();   ///< measured [rad/s]
  Vector3d accel_B = Vector3d::Zero();  ///< of the body, in axes that turn with it [m/s^2]
  /// How a radar's scan of this state was taken.
  struct Scanned {
    bool here = false;         ///< it has one
    double time_offset = 0.0;  ///< with which its time was chosen [s]
    RadarErrors::Value radar_errors = RadarErrors::Value::Zero();  ///< with which it was corrected
  };
  std::array<Scanned, kMaxRadars> scanned;
  ImuFactor to_next;  ///< not valid for the newest
  std::vector<DopplerFactor> dopplers;
  std::vector<PointFactor> points;
  std::vector<DistanceFactor> distances;
  std::vector<PositionFactor> positions;
  std::vector<TrailFactor> trails;
  std::vector<AidingFactor> aiding;
  std::optional<RestModel::Measurement> rest;

  /// How many measurements there are, to come back to.
  struct Mark {
    std::size_t dopplers = 0;
    std::size_t points = 0;
    std::size_t distances = 0;
    std::size_t positions = 0;
    std::size_t trails = 0;
    std::optional<RestModel::Measurement> rest;
  };
  Mark mark() const;
  void cut(const Mark& mark);

  void clear();
};

/// First in, first out; index 0 is the oldest.
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
  /// An empty state, the newest from now on.
  WindowState& push();
  void pop_oldest();
  void pop_newest() { --size_; }

  /// Index of the first state not before `time`, size() if there is none.
  std::size_t first_from(Time time) const;

  /// Index of the state of `scan`, or -1.
  int find(ScanId scan) const;

  /// Its poses become the clones of x, for matching and for the trails.
  void publish(Estimate* x) const;

  /// Landmark i is gone and the last one has taken its place.
  void forget_landmark(std::size_t i, std::size_t last);

 private:
  std::vector<WindowState> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

/// Columns of [states | border] for the models: `state` is the one that measures.
struct WindowLayout {
  Layout newest;  ///< [newest state | border] without clones, of the radar that measures
  int states = 0;
  int state = 0;

  int border_column() const { return body::kSize * states; }

  template <class Block>
  int column(int index) const {
    const int own = body::kSize * state;
    if constexpr (std::is_same_v<Block, BodyPose>) return own + body::kAttitude;
    if constexpr (std::is_same_v<Block, BodyVelocity>) return own + body::kVelocity;
    if constexpr (std::is_same_v<Block, GyroBias>) return own + body::kGyroBias;
    if constexpr (std::is_same_v<Block, ClonePose>) return body::kSize * index + body::kAttitude;
    return shifted(newest.column<Block>(index));
  }
  int time_offset_column() const { return shifted(newest.time_offset_column()); }
  AidingColumns aiding_columns() const {
    return {body::kSize * state, shifted(newest.auxiliary())};
  }

 private:
  int shifted(int column) const { return column < 0 ? -1 : column - body::kSize + border_column(); }
};

}  // namespace rio
