// SPDX-License-Identifier: BSD-3-Clause
// Position of each block in the error state:
//   [body 15 | of each radar: extrinsics 0 or 6, Doppler scale 0 or 1, time offset 0 or 1,
//    elevation error 0 or 1 | auxiliary states | clones 6 N | landmarks 3 M]
//
// The clone region always has room for N clones (stochastic cloning); a new one replaces the
// oldest, so marginalising a clone moves nothing. Landmarks come last because their number changes.
#pragma once

#include "rio/options.hpp"
#include "rio/state/blocks.hpp"

namespace rio {

/// Column indices of the error state; constant but for the selected radar.
class Layout {
 public:
  /// @param auxiliary number of elements of the auxiliary states
  Layout(const CalibrationOptions& calibration, int max_clones, int max_landmarks,
         int auxiliary = 0, std::size_t radars = 1)
      : extrinsics_(calibration.rotation_sigma > 0.0 || calibration.translation_sigma > 0.0),
        doppler_scale_(calibration.doppler_scale_sigma > 0.0),
        time_offset_(calibration.time_offset_sigma > 0.0),
        elevation_error_(calibration.elevation_sigma > 0.0),
        radars_(static_cast<int>(radars)),
        auxiliary_(auxiliary),
        max_clones_(max_clones),
        max_landmarks_(max_landmarks) {}

  /// The same layout, with the calibration columns of radar r selected.
  Layout of_radar(std::size_t r) const {
    Layout out = *this;
    out.radar_ = static_cast<int>(r);
    return out;
  }
  std::size_t radars() const { return static_cast<std::size_t>(radars_); }

  bool has_extrinsics() const { return extrinsics_; }
  bool has_doppler_scale() const { return doppler_scale_; }
  bool has_time_offset() const { return time_offset_; }
  bool has_elevation_error() const { return elevation_error_; }
  int max_clones() const { return max_clones_; }

  // First column of each block, the calibration that of the selected radar. Valid only for blocks
  // that are estimated.
  int extrinsics() const { return body::kSize + radar_ * calibration_size(); }
  int doppler_scale() const { return extrinsics() + (extrinsics_ ? Extrinsics::kDof : 0); }
  int time_offset() const { return doppler_scale() + (doppler_scale_ ? 1 : 0); }
  int elevation_error() const { return time_offset() + (time_offset_ ? 1 : 0); }
  int auxiliary() const { return body::kSize + radars_ * calibration_size(); }
  int auxiliary_size() const { return auxiliary_; }
  int clone(int slot) const { return auxiliary() + auxiliary_ + 6 * slot; }
  int landmark(int index) const { return clone(max_clones_) + 3 * index; }
  int size(int landmarks) const { return landmark(landmarks); }
  int capacity() const { return size(max_landmarks_); }

  /// First column of a block; `index` selects the clone slot or the landmark. -1 = not estimated.
  template <class Block>
  int column(int index) const {
    if constexpr (std::is_same_v<Block, BodyPose>) return body::kAttitude;
    if constexpr (std::is_same_v<Block, BodyVelocity>) return body::kVelocity;
    if constexpr (std::is_same_v<Block, GyroBias>) return body::kGyroBias;
    if constexpr (std::is_same_v<Block, Extrinsics>) return extrinsics_ ? extrinsics() : -1;
    if constexpr (std::is_same_v<Block, DopplerScale>) return doppler_scale_ ? doppler_scale() : -1;
    if constexpr (std::is_same_v<Block, ElevationError>)
      return elevation_error_ ? elevation_error() : -1;
    if constexpr (std::is_same_v<Block, ClonePose>) return max_clones_ > 0 ? clone(index) : -1;
    if constexpr (std::is_same_v<Block, Landmark>) return landmark(index);
  }
  /// Column of the time offset, -1 = not estimated.
  int time_offset_column() const { return time_offset_ ? time_offset() : -1; }

 private:
  /// Columns of the calibration of one radar.
  int calibration_size() const {
    return (extrinsics_ ? Extrinsics::kDof : 0) + (doppler_scale_ ? 1 : 0) +
           (time_offset_ ? 1 : 0) + (elevation_error_ ? 1 : 0);
  }

  bool extrinsics_;
  bool doppler_scale_;
  bool time_offset_;
  bool elevation_error_;
  int radars_;
  int radar_ = 0;
  int auxiliary_;
  int max_clones_;
  int max_landmarks_;
};

}  // namespace rio
