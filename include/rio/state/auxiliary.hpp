// SPDX-License-Identifier: BSD-3-Clause
// Auxiliary states, which extensions add to the estimator's own and declare in the options. C++17.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstring>

#include "rio/core/static_vector.hpp"

namespace rio {

/// One auxiliary state (AuxiliaryBlock in state/blocks.hpp).
struct AuxiliaryState {
  const char* name = "";  ///< of static lifetime
  int size = 0;           ///< elements
  double sigma = 0.0;     ///< prior, per element, at most 1e6 [its unit]
  double walk = 0.0;      ///< density of the random walk [its unit / sqrt(s)]; 0 = a constant
  int index = 0;          ///< among those of one kind (AuxiliaryBlockBase::kIndexed)
  /// Not known well enough to linearise, like the place of an anchor that measures ranges only: its
  /// measurements are held back until they determine it (update/delayed_start.hpp). Needs walk = 0.
  bool delayed = false;
  static constexpr int kMaxSize = 12;
  std::array<double, kMaxSize> initial{};  ///< value of each element at the start [its unit]
};

/// The state of a block with the block's prior and random walk.
template <class Block>
AuxiliaryState auxiliary_state(int index = 0) {
  static_assert(Block::kDof <= AuxiliaryState::kMaxSize, "an auxiliary state is too large");
  AuxiliaryState state;
  state.name = Block::kName;
  state.size = Block::kDof;
  state.sigma = Block::kSigma;
  state.walk = Block::kWalk;
  state.index = index;
  return state;
}

/// Most elements of all states together.
inline constexpr int kMaxAuxiliary = 36;

/// Values of all states in the order of declaration; unused elements at the end are 0.
using AuxiliaryValues = Eigen::Matrix<double, kMaxAuxiliary, 1, Eigen::DontAlign>;

/// All auxiliary states of an estimator, one after the other.
class AuxiliaryStates {
 public:
  static constexpr std::size_t kMaxStates = 16;

  /// Adds a block with its default prior and random walk, or with those given. False, and nothing
  /// is added, if there is no room or the name is taken.
  template <class Block>
  bool declare(double sigma = Block::kSigma, double walk = Block::kWalk) {
    return declare_at<Block>(Block::Value::Zero(), sigma, walk);
  }
  /// The same, with the value at the start, which is zero otherwise.
  template <class Block>
  bool declare_at(const typename Block::Value& initial, double sigma = Block::kSigma,
                  double walk = Block::kWalk) {
    AuxiliaryState state = auxiliary_state<Block>();
    state.sigma = sigma;
    state.walk = walk;
    std::copy(initial.data(), initial.data() + Block::kDof, state.initial.begin());
    return declare(state);
  }
  /// The same for one of several of a kind, or one that starts delayed.
  bool declare(const AuxiliaryState& state) {
    if (find(state.name, state.index) >= 0 || size_ + state.size > kMaxAuxiliary ||
        !states_.push_back(state)) {
      return false;
    }
    size_ += state.size;
    return true;
  }

  /// First element of the state of that name and index, -1 if it is not declared.
  /// @param size if given, its elements
  int find(const char* name, int index = 0, int* size = nullptr) const {
    int first = 0;
    for (const AuxiliaryState& state : states_) {
      if (state.index == index && std::strcmp(state.name, name) == 0) {
        if (size != nullptr) *size = state.size;
        return first;
      }
      first += state.size;
    }
    return -1;
  }

  /// Of all states, in the order of declaration.
  AuxiliaryValues initial() const {
    AuxiliaryValues values = AuxiliaryValues::Zero();
    int first = 0;
    for (const AuxiliaryState& state : states_) {
      for (int i = 0; i < state.size; ++i) {
        values[first++] = state.initial[static_cast<std::size_t>(i)];
      }
    }
    return values;
  }

  /// Elements of all states together.
  int size() const { return size_; }
  const AuxiliaryState* begin() const { return states_.begin(); }
  const AuxiliaryState* end() const { return states_.end(); }

 private:
  StaticVector<AuxiliaryState, kMaxStates> states_;
  int size_ = 0;
};

}  // namespace rio
