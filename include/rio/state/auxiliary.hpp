// SPDX-License-Identifier: BSD-3-Clause
// Auxiliary states, which extensions add to the estimator's own and declare in the options. C++17.
#pragma once

#include <Eigen/Core>
#include <cstring>

#include "rio/core/static_vector.hpp"

namespace rio {

/// One auxiliary state (AuxiliaryBlock in state/blocks.hpp).
struct AuxiliaryState {
  const char* name = "";  ///< of static lifetime
  int size = 0;           ///< elements
  double sigma = 0.0;     ///< prior, per element [its unit]
  double walk = 0.0;      ///< density of the random walk [its unit / sqrt(s)]; 0 = a constant
};

/// All auxiliary states of an estimator, one after the other.
class AuxiliaryStates {
 public:
  static constexpr std::size_t kMaxStates = 8;
  static constexpr int kMaxSize = 12;  ///< elements of all states together

  /// Adds a block with its default prior and random walk, or with those given. False, and nothing
  /// is added, if there is no room or the name is taken.
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

  /// Elements of all states together.
  int size() const { return size_; }
  const AuxiliaryState* begin() const { return states_.begin(); }
  const AuxiliaryState* end() const { return states_.end(); }

 private:
  StaticVector<AuxiliaryState, kMaxStates> states_;
  int size_ = 0;
};

/// Values of all states in the order of declaration; unused elements at the end are 0.
using AuxiliaryValues = Eigen::Matrix<double, AuxiliaryStates::kMaxSize, 1>;

}  // namespace rio
