// SPDX-License-Identifier: BSD-3-Clause
// Stage 3 for external models: a measurement with its model, type-erased, in a type of fixed size
// that both back-ends accept. C++17.
//
// A model is a struct with
//   kName         its name in the report
//   kDim          rows of one measurement, up to 6
//   Blocks        BlockList of what it depends on: BodyPose, BodyVelocity, GyroBias, Extrinsics and
//                 DopplerScale of one radar, and auxiliary states of its own (AuxiliaryBlock in
//                 state/blocks.hpp)
//   Measurement   what was measured, with its noise
//   bool evaluate(z, value of each block ..., r, J, R) const
//                 r = z - h(x);  J = dh/dx in the errors of the blocks, may be null;  R =
//                 covariance of r at the true state; false = outside the model's domain
// and may have
//   static bool is_valid(z)   the noise of z is one: otherwise the measurement is refused
// The state at its time follows from that of the next scan by the IMU in between
// (update/aiding.hpp); its rows are gated like any other, and the smoother's window keeps it as
// long as that scan. A calibration that is not estimated has its configured value and no column.
// A model of radar points measures at the time of the scan, its points left out of the scan that
// the odometry gets (src/examples/07_radar_point_model.cpp).
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>

#include "rio/core/small_cholesky.hpp"
#include "rio/state/auxiliary.hpp"
#include "rio/state/blocks.hpp"
#include "rio/types.hpp"

namespace rio {

/// The state an external measurement depends on, at its time.
struct AidedState {
  RigidPose T_WB;
  Vector3d v_WB = Vector3d::Zero();       ///< [m/s]
  Vector3d gyro_bias = Vector3d::Zero();  ///< [rad/s]
  RigidPose T_BS;                         ///< of the measurement's radar
  double doppler_scale = 0.0;             ///< relative error of its range rates as received
  const AuxiliaryStates* states = nullptr;
  const AuxiliaryValues* auxiliary = nullptr;
};

/// First columns of the blocks in the error state, of the measurement's radar; -1 = not estimated.
struct AidingColumns {
  int body = 0;
  int extrinsics = -1;
  int doppler_scale = -1;
  int auxiliary = 0;
};

/// A measurement with its model, type-erased; copied without allocation.
class AidingMeasurement {
 public:
  static constexpr int kMaxRows = 6;
  static constexpr int kMostSegments = 6;  ///< blocks beside those of the body
  /// Columns of the Jacobian: errors of pose, velocity and gyro bias, then the model's other
  /// blocks.
  static constexpr int kBody = 12;
  static constexpr int kColumns = kBody + AuxiliaryState::kMaxSize;
  /// Room for model and measurement [bytes].
  static constexpr std::size_t kCapacity = 320;
  static constexpr std::size_t kAlignment = 32;

  /// Whitened rows r = J dx + n, cov(n) = I.
  struct Rows {
    struct Segment {
      int column = 0;  ///< first, in the error state
      int length = 0;
    };
    int count = 0;
    // filled by the compiler flags of the user, read by those of the library
    template <int kWidth>
    using Matrix = Eigen::Matrix<double, kMaxRows, kWidth, Eigen::DontAlign>;
    Matrix<1> r = Matrix<1>::Zero();
    Matrix<kColumns> J = Matrix<kColumns>::Zero();
    StaticVector<Segment, static_cast<std::size_t>(kMostSegments)>
        segments;  ///< where the columns after kBody belong
  };

  /// @param radar whose Extrinsics and DopplerScale the model has, if it has any
  /// @param index of its auxiliary states that are indexed, the same for each kind
  template <class Model>
  AidingMeasurement(Time time, const Model& model, const typename Model::Measurement& z,
                    std::size_t radar = 0, int index = 0)
      : time_(time), radar_(radar), index_(index), table_(&kTable<Model>) {
    using Both = Held<Model>;
    static_assert(Model::kDim <= kMaxRows, "at most six rows");
    static_assert(Of<Model, typename Model::Blocks>::kOthers <= kColumns - kBody,
                  "too many columns beside pose, velocity and gyro bias");
    static_assert(Of<Model, typename Model::Blocks>::kOtherBlocks <= kMostSegments,
                  "too many blocks beside pose, velocity and gyro bias");
    static_assert(sizeof(Both) <= kCapacity, "model and measurement are too large");
    static_assert(alignof(Both) <= kAlignment, "model and measurement are aligned too widely");
    static_assert(std::is_trivially_destructible_v<Both>, "neither may own anything");
    new (storage_) Both{model, z};
  }
  AidingMeasurement(const AidingMeasurement& other)
      : time_(other.time_), radar_(other.radar_), index_(other.index_), table_(other.table_) {
    table_->copy(other.storage_, storage_);
  }
  AidingMeasurement& operator=(const AidingMeasurement& other) {
    if (this == &other) return *this;
    time_ = other.time_;
    radar_ = other.radar_;
    index_ = other.index_;
    table_ = other.table_;
    table_->copy(other.storage_, storage_);
    return *this;
  }
  ~AidingMeasurement() = default;

  Time time() const { return time_; }
  std::size_t radar() const { return radar_; }
  const char* name() const { return table_->name; }
  int rows() const { return table_->rows; }
  /// By Model::is_valid(), if the model has it.
  bool is_valid() const { return table_->is_valid(storage_); }
  /// All auxiliary states the model depends on are among these.
  bool is_declared(const AuxiliaryStates& states) const {
    return table_->is_declared(states, index_);
  }
  /// It depends on the auxiliary state with that first element.
  bool depends_on(const AuxiliaryStates& states, int first) const {
    return table_->depends_on(states, index_, first);
  }
  /// Rows at x. False: outside the domain of the model, or not finite, or R is no covariance.
  bool evaluate(const AidedState& x, const AidingColumns& columns, Rows* rows) const {
    return table_->evaluate(storage_, index_, x, columns, rows) && rows->r.allFinite() &&
           rows->J.allFinite();
  }

 private:
  struct Table {
    const char* name;
    int rows;
    bool (*is_declared)(const AuxiliaryStates&, int index);
    bool (*depends_on)(const AuxiliaryStates&, int index, int first);
    bool (*evaluate)(const void*, int index, const AidedState&, const AidingColumns&, Rows*);
    void (*copy)(const void*, void*);
    bool (*is_valid)(const void*);
  };
  template <class Model>
  struct Held {
    Model model;
    typename Model::Measurement z;
  };

  template <class Block>
  static constexpr bool kIsAuxiliary = std::is_base_of_v<AuxiliaryBlockBase, Block>;
  /// Column of a body block in Rows::J, -1 for the others.
  template <class Block>
  static constexpr int kBodyColumn = std::is_same_v<Block, BodyPose>       ? body::kAttitude
                                     : std::is_same_v<Block, BodyVelocity> ? body::kVelocity
                                     : std::is_same_v<Block, GyroBias>     ? body::kGyroBias
                                                                           : -1;

  /// First element among the auxiliary states, -1 if it is not declared so, or another block.
  template <class Block>
  static int element([[maybe_unused]] const AuxiliaryStates& states, [[maybe_unused]] int index) {
    if constexpr (kIsAuxiliary<Block>) {
      int size = 0;
      const int first = states.find(Block::kName, Block::kIndexed ? index : 0, &size);
      if (size == Block::kDof) return first;
    }
    return -1;
  }
  template <class Block>
  static typename Block::Value value(const AidedState& x, [[maybe_unused]] int index) {
    if constexpr (std::is_same_v<Block, BodyPose>) {
      return x.T_WB;
    } else if constexpr (std::is_same_v<Block, BodyVelocity>) {
      return x.v_WB;
    } else if constexpr (std::is_same_v<Block, GyroBias>) {
      return x.gyro_bias;
    } else if constexpr (std::is_same_v<Block, Extrinsics>) {
      return x.T_BS;
    } else if constexpr (std::is_same_v<Block, DopplerScale>) {
      return x.doppler_scale;
    } else {
      static_assert(kIsAuxiliary<Block>, "no block that an external model can measure");
      return x.auxiliary->template segment<Block::kDof>(element<Block>(*x.states, index));
    }
  }
  /// First column in the error state of a block that is not of the body.
  template <class Block>
  static int column(const AuxiliaryStates& states, [[maybe_unused]] int index,
                    const AidingColumns& columns) {
    if constexpr (std::is_same_v<Block, Extrinsics>) return columns.extrinsics;
    if constexpr (std::is_same_v<Block, DopplerScale>) return columns.doppler_scale;
    if constexpr (kIsAuxiliary<Block>) return columns.auxiliary + element<Block>(states, index);
  }

  template <class Model, class List>
  struct Of;
  template <class Model, class... B>
  struct Of<Model, BlockList<B...>> {
    /// Columns of the blocks that are not of the body.
    static constexpr int kOthers = ((kBodyColumn<B> < 0 ? B::kDof : 0) + ...);
    static constexpr int kOtherBlocks = ((kBodyColumn<B> < 0 ? 1 : 0) + ...);

    static bool is_declared(const AuxiliaryStates& states, int index) {
      return ((!kIsAuxiliary<B> || element<B>(states, index) >= 0) && ...);
    }
    static bool depends_on(const AuxiliaryStates& states, int index, int first) {
      return ((kIsAuxiliary<B> && element<B>(states, index) == first) || ...);
    }
    static bool evaluate(const void* held, int index, const AidedState& x,
                         const AidingColumns& columns, Rows* rows) {
      constexpr int kDim = Model::kDim;
      const auto& both = *static_cast<const Held<Model>*>(held);
      Eigen::Matrix<double, kDim, 1> r;
      Eigen::Matrix<double, kDim, BlockList<B...>::kDof> J;
      Eigen::Matrix<double, kDim, kDim> R;
      if (!both.model.evaluate(both.z, value<B>(x, index)..., r, &J, R)) return false;
      if (!is_definite(R)) return false;
      const SmallCholesky<kDim> root(R);
      J = root.whitened(J);
      *rows = {};
      rows->count = kDim;
      rows->r.template head<kDim>() = root.whitened(r);
      int others = kBody;
      (place<B>(J, *x.states, index, columns, &others, rows), ...);
      return true;
    }
    template <class Block, class Jacobian>
    static void place(const Jacobian& J, const AuxiliaryStates& states, int index,
                      const AidingColumns& columns, int* others, Rows* rows) {
      int to = kBodyColumn<Block>;
      if constexpr (kBodyColumn<Block> < 0) {
        const int estimated = column<Block>(states, index, columns);
        if (estimated < 0) return;
        (void)rows->segments.push_back({estimated, Block::kDof});
        to = *others;
        *others += Block::kDof;
      }
      rows->J.template block<Model::kDim, Block::kDof>(0, to) =
          J.template middleCols<Block::kDof>(BlockList<B...>::template column<Block>());
    }
  };
  template <class Model>
  static auto judge(const typename Model::Measurement& z, int) -> decltype(Model::is_valid(z)) {
    return Model::is_valid(z);
  }
  template <class Model>
  static bool judge(const typename Model::Measurement& /*z*/, long) {
    return true;
  }
  template <class Model>
  static bool is_valid(const void* held) {
    return judge<Model>(static_cast<const Held<Model>*>(held)->z, 0);
  }
  template <class Model>
  static void copy(const void* from, void* to) {
    new (to) Held<Model>(*static_cast<const Held<Model>*>(from));
  }
  template <class Model>
  static constexpr Table kTable = {Model::kName,
                                   Model::kDim,
                                   &Of<Model, typename Model::Blocks>::is_declared,
                                   &Of<Model, typename Model::Blocks>::depends_on,
                                   &Of<Model, typename Model::Blocks>::evaluate,
                                   &AidingMeasurement::copy<Model>,
                                   &AidingMeasurement::is_valid<Model>};

  Time time_;
  std::size_t radar_;
  int index_;
  const Table* table_;
  alignas(kAlignment) std::byte storage_[kCapacity];
};

}  // namespace rio
