// SPDX-License-Identifier: BSD-3-Clause
// Where each block lives in the error state:
//   [body 15 | extrinsics 0 or 6 | clones 6 N | landmarks 3 M]
//
// The clone region always has room for N clones; a new clone takes the place of the oldest one, so
// marginalising a clone moves nothing. Landmarks stand last because their number changes.
#pragma once

#include "rio/options.hpp"
#include "rio/state/blocks.hpp"

namespace rio {

class Layout {
 public:
  explicit Layout(const UpdateOptions& options)
      : extrinsics_(options.extrinsic_rotation_sigma > 0.0 ||
                    options.extrinsic_translation_sigma > 0.0),
        max_clones_(options.max_clones),
        max_landmarks_(options.max_landmarks) {}

  bool has_extrinsics() const { return extrinsics_; }
  int max_clones() const { return max_clones_; }
  int max_landmarks() const { return max_landmarks_; }
  int extrinsics() const { return body::kSize; }
  int clone(int slot) const { return body::kSize + (extrinsics_ ? 6 : 0) + 6 * slot; }
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
    if constexpr (std::is_same_v<Block, ClonePose>) return clone(index);
    if constexpr (std::is_same_v<Block, Landmark>) return landmark(index);
  }

 private:
  bool extrinsics_;
  int max_clones_;
  int max_landmarks_;
};

}  // namespace rio
