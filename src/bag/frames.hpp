// SPDX-License-Identifier: BSD-3-Clause
// The tree of frames of /tf_static.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rio/bag/messages.hpp"

namespace rio::bag {

class Frames {
 public:
  void add(const std::vector<Transform>& transforms) {
    for (const Transform& t : transforms) of_child_[t.child] = t;
  }
  /// The pose of a frame in another one; empty if they are not in one tree.
  std::optional<Pose> pose(const std::string& frame, const std::string& in) const {
    const auto [root, a] = to_root(frame);
    const auto [other_root, b] = to_root(in);
    if (root != other_root || root.empty()) return std::nullopt;
    const Quaternion back = b.rotation.conjugate();
    return Pose{back * a.rotation, back * (a.translation - b.translation)};
  }

 private:
  struct Rooted {
    std::string root;  ///< empty: a loop
    Pose pose;
  };
  Rooted to_root(std::string frame) const {
    if (frame.starts_with('/')) frame.erase(0, 1);
    Pose pose;
    for (std::size_t i = 0; i <= of_child_.size(); ++i) {
      const auto up = of_child_.find(frame);
      if (up == of_child_.end()) return {frame, pose};
      const Pose& T = up->second.pose;
      pose = {T.rotation * pose.rotation, T.rotation * pose.translation + T.translation};
      frame = up->second.parent;
    }
    return {};
  }

  std::map<std::string, Transform> of_child_;
};

}  // namespace rio::bag
