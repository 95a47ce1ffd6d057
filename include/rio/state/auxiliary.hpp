// SPDX-License-Identifier: BSD-3-Clause
// The states that extensions add to the estimator's own, as declared in the options. C++17.
#pragma once

#include <Eigen/Core>
#include <cstring>

#include "rio/core/static_vector.hpp"

namespace rio {

/// One of them (AuxiliaryBlock in state/blocks.hpp).
struct AuxiliaryState {
  const char* name = "";  ///< of static lifetime
  int size = 0;           ///< elements
  double sigma = 0.0;     ///< prior, per element [its unit]
  double walk = 0.0;      ///< density of the random walk [its unit / sqrt(s)]; 0 = a constant
};

/// All of them, one after the other.
class AuxiliaryStates {
 public:
  static constexpr std::size_t kMaxStates = 8;
  static constexpr int kMaxSize = 12;  ///< elements of all together

  /// Adds a block, with its own prior and walk or others. False, and nothing is added, if there is
  /// no room or the name is taken.
  template <class Block>
  bool declare(double sigma = Block::kSigma, double walk = Block::kWalk) {
    return declare(AuxiliaryState{Block::kName, Block::kDof, sigma, walk});
  }
  bool declare(const AuxiliaryState& state) {
    if (find(state.name) >= 0 || size_ + state.size > kMaxSize || !states_.push_back(state)) {
      return false;
    }
    size_ += state.size;
    return true;
  }

  /// First element of the state of that name, -1 if it is not declared.
  int find(const char* name) const {
    int first = 0;
    for (const AuxiliaryState& state : states_) {
      if (std::strcmp(state.name, name) == 0) return first;
      first += state.size;
    }
    return -1;
  }

  /// Elements of all together.
  int size() const { return size_; }
  const AuxiliaryState* begin() const { return states_.begin(); }
  const AuxiliaryState* end() const { return states_.end(); }

 private:
  StaticVector<AuxiliaryState, kMaxStates> states_;
  int size_ = 0;
};

/// The values of all, in the order they were declared; what is beyond AuxiliaryStates::size() is 0.
using AuxiliaryValues = Eigen::Matrix<double, AuxiliaryStates::kMaxSize, 1>;

}  // namespace rio
