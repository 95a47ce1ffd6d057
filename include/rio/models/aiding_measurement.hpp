// SPDX-License-Identifier: BSD-3-Clause
// Stage 3 for sensors other than the radar: a measurement with its model, type-erased, in a type of
// fixed size that both back-ends accept. C++17.
//
// A model is a struct with
//   kName         its name in the report
//   kDim          rows of one measurement, up to 6
//   Blocks        BlockList of what it depends on: BodyPose, BodyVelocity, GyroBias, and auxiliary
//                 states of its own (AuxiliaryBlock in state/blocks.hpp)
//   Measurement   what was measured, with its noise
//   bool evaluate(z, value of each block ..., r, J, R) const
//                 r = z - h(x);  J = dh/dx in the errors of the blocks, may be null;  R =
//                 covariance of r at the true state; false = outside the model's domain
// The state at its time follows from that of the next scan by the IMU in between
// (update/aiding.hpp); its rows are gated like any other, and the smoother's window keeps it as
// long as that scan.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>

#include "rio/core/whiten.hpp"
#include "rio/state/auxiliary.hpp"
#include "rio/state/blocks.hpp"
#include "rio/types.hpp"

namespace rio {

/// The state a measurement of another sensor depends on, at its time.
struct AidedState {
  RigidPose T_WB;
  Vector3d v_WB = Vector3d::Zero();       ///< [m/s]
  Vector3d gyro_bias = Vector3d::Zero();  ///< [rad/s]
  const AuxiliaryStates* states = nullptr;
  const AuxiliaryValues* auxiliary = nullptr;
};

/// A measurement with its model, type-erased; copied without allocation.
class AidingMeasurement {
 public:
  static constexpr int kMaxRows = 6;
  /// Columns of the Jacobian: errors of pose, velocity, gyro bias, and the auxiliary states.
  static constexpr int kBody = 12;
  static constexpr int kColumns = kBody + AuxiliaryStates::kMaxSize;
  /// Room for model and measurement [bytes].
  static constexpr std::size_t kCapacity = 320;
  static constexpr std::size_t kAlignment = 32;

  /// Whitened rows r = J dx + n, cov(n) = I.
  struct Rows {
    int count = 0;
    Eigen::Matrix<double, kMaxRows, 1> r = Eigen::Matrix<double, kMaxRows, 1>::Zero();
    Eigen::Matrix<double, kMaxRows, kColumns> J = Eigen::Matrix<double, kMaxRows, kColumns>::Zero();
  };

  template <class Model>
  AidingMeasurement(Time time, const Model& model, const typename Model::Measurement& z)
      : time_(time), table_(&kTable<Model>) {
    using Both = Held<Model>;
    static_assert(Model::kDim <= kMaxRows, "at most six rows");
    static_assert(sizeof(Both) <= kCapacity, "model and measurement are too large");
    static_assert(alignof(Both) <= kAlignment, "model and measurement are aligned too widely");
    static_assert(std::is_trivially_destructible_v<Both>, "neither may own anything");
    new (storage_) Both{model, z};
  }
  AidingMeasurement(const AidingMeasurement& other) : time_(other.time_), table_(other.table_) {
    table_->copy(other.storage_, storage_);
  }
  AidingMeasurement& operator=(const AidingMeasurement& other) {
    if (this == &other) return *this;
    time_ = other.time_;
    table_ = other.table_;
    table_->copy(other.storage_, storage_);
    return *this;
  }
  ~AidingMeasurement() = default;

  Time time() const { return time_; }
  const char* name() const { return table_->name; }
  /// All auxiliary states the model depends on are among these.
  bool is_declared(const AuxiliaryStates& states) const { return table_->is_declared(states); }
  /// Rows at x. False: outside the domain of the model, or not finite.
  bool evaluate(const AidedState& x, Rows* rows) const {
    return table_->evaluate(storage_, x, rows) && rows->r.allFinite() && rows->J.allFinite();
  }

 private:
  struct Table {
    const char* name;
    bool (*is_declared)(const AuxiliaryStates&);
    bool (*evaluate)(const void*, const AidedState&, Rows*);
    void (*copy)(const void*, void*);
  };
  template <class Model>
  struct Held {
    Model model;
    typename Model::Measurement z;
  };

  template <class Block>
  static constexpr bool kIsAuxiliary = std::is_base_of_v<AuxiliaryBlockBase, Block>;

  template <class Block>
  static typename Block::Value value(const AidedState& x) {
    if constexpr (std::is_same_v<Block, BodyPose>) {
      return x.T_WB;
    } else if constexpr (std::is_same_v<Block, BodyVelocity>) {
      return x.v_WB;
    } else if constexpr (std::is_same_v<Block, GyroBias>) {
      return x.gyro_bias;
    } else {
      static_assert(kIsAuxiliary<Block>, "no block that other sensors can measure");
      return x.auxiliary->template segment<Block::kDof>(x.states->find(Block::kName));
    }
  }
  /// First column of a block in Rows::J, -1 = not declared.
  template <class Block>
  static int column(const AuxiliaryStates& states) {
    if constexpr (std::is_same_v<Block, BodyPose>) return body::kAttitude;
    if constexpr (std::is_same_v<Block, BodyVelocity>) return body::kVelocity;
    if constexpr (std::is_same_v<Block, GyroBias>) return body::kGyroBias;
    if constexpr (kIsAuxiliary<Block>) {
      const int first = states.find(Block::kName);
      return first < 0 ? -1 : kBody + first;
    }
  }

  template <class Model, class List>
  struct Of;
  template <class Model, class... B>
  struct Of<Model, BlockList<B...>> {
    static bool is_declared(const AuxiliaryStates& states) {
      return ((column<B>(states) >= 0) && ...);
    }
    static bool evaluate(const void* held, const AidedState& x, Rows* rows) {
      constexpr int kDim = Model::kDim;
      const auto& both = *static_cast<const Held<Model>*>(held);
      Eigen::Matrix<double, kDim, 1> r;
      Eigen::Matrix<double, kDim, BlockList<B...>::kDof> J;
      Eigen::Matrix<double, kDim, kDim> R;
      if (!both.model.evaluate(both.z, value<B>(x)..., r, &J, R)) return false;
      whiten<kDim, BlockList<B...>::kDof>(R, &r, &J);
      rows->count = kDim;
      rows->r.setZero();
      rows->J.setZero();
      rows->r.template head<kDim>() = r;
      (place<B>(J, *x.states, rows), ...);
      return true;
    }
    template <class Block, class Jacobian>
    static void place(const Jacobian& J, const AuxiliaryStates& states, Rows* rows) {
      rows->J.template block<Model::kDim, Block::kDof>(0, column<Block>(states)) =
          J.template middleCols<Block::kDof>(BlockList<B...>::template column<Block>());
    }
  };
  template <class Model>
  static void copy(const void* from, void* to) {
    new (to) Held<Model>(*static_cast<const Held<Model>*>(from));
  }
  template <class Model>
  static constexpr Table kTable = {Model::kName, &Of<Model, typename Model::Blocks>::is_declared,
                                   &Of<Model, typename Model::Blocks>::evaluate,
                                   &AidingMeasurement::copy<Model>};

  Time time_;
  const Table* table_;
  alignas(kAlignment) std::byte storage_[kCapacity];
};

}  // namespace rio
