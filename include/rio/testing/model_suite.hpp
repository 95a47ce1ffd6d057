// SPDX-License-Identifier: BSD-3-Clause
// The test suite that every measurement model passes. A case simulates one measurement of a model;
// adding a model is one case and one line in the type list.
//
// A case has
//   using Model;  static Model model();
//   static Sample<Model> simulate(sim::Random&, bool noise)
//       true state, and z from sim/'s projection
//   static std::optional<Sample<Model>> outside(sim::Random&)
//       a state outside the domain, if there is one
//   static constexpr double kUnit  magnitude of the measurement, for rounding; default 1
// and is instantiated in namespace rio::test.
//
// The suite itself computes with matrices of any size, which are compiled once for all models.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <optional>

#include "rio/models/concept.hpp"
#include "rio/sim/random.hpp"
#include "rio/testing/allocation_guard.hpp"

namespace rio::test {

/// A measurement and the true values of the blocks it depends on.
template <class M>
struct Sample {
  typename M::Measurement z;
  typename M::Blocks::Values x;
};

template <class Case>
class ModelSuite : public testing::Test {
 protected:
  static constexpr double unit() {
    if constexpr (requires { Case::kUnit; }) return Case::kUnit;
    return 1.0;
  }
};

/// The block values with `error` applied through each block's retraction.
template <class... B>
typename BlockList<B...>::Values retract(BlockList<B...>, const typename BlockList<B...>::Values& x,
                                         const Eigen::VectorXd& error) {
  Eigen::Index at = 0;
  const auto next = [&]<class Block>(std::type_identity<Block>, const auto& value) {
    const Eigen::Matrix<double, Block::kDof, 1> e = error.segment<Block::kDof>(at);
    at += Block::kDof;
    return Block::retract(value, e);
  };
  return std::apply(
      [&](const auto&... value) {
        // braces: evaluated left to right
        return typename BlockList<B...>::Values{next(std::type_identity<B>{}, value)...};
      },
      x);
}

/// Central differences of h = z - r in every error direction.
template <class M>
Eigen::MatrixXd numeric_jacobian(const M& model, const Sample<M>& sample, double step) {
  Eigen::MatrixXd J(M::kDim, M::Blocks::kDof);
  for (int i = 0; i < M::Blocks::kDof; ++i) {
    Evaluation<M> plus;
    Evaluation<M> minus;
    const Eigen::VectorXd e = Eigen::VectorXd::Unit(M::Blocks::kDof, i) * step;
    EXPECT_TRUE(evaluate(model, sample.z, retract(typename M::Blocks{}, sample.x, e), &plus));
    EXPECT_TRUE(evaluate(model, sample.z, retract(typename M::Blocks{}, sample.x, -e), &minus));
    J.col(i) = (Eigen::VectorXd(minus.r) - Eigen::VectorXd(plus.r)) / (2.0 * step);
  }
  return J;
}

TYPED_TEST_SUITE_P(ModelSuite);

TYPED_TEST_P(ModelSuite, JacobianMatchesCentralDifferences) {
  sim::Random random(11);
  using M = typename TypeParam::Model;
  const M model = TypeParam::model();
  for (const double size : {0.0, 1e-8, 0.3}) {  // at the truth, near it, and far from it
    for (int i = 0; i < 100; ++i) {
      Sample<M> sample = TypeParam::simulate(random, true);
      Eigen::VectorXd e(M::Blocks::kDof);
      for (double& value : e) value = size * random.uniform(-1.0, 1.0);
      sample.x = retract(typename M::Blocks{}, sample.x, e);
      Evaluation<M> at;
      ASSERT_TRUE(evaluate(model, sample.z, sample.x, &at));
      const Eigen::MatrixXd J = at.J;
      const Eigen::MatrixXd numeric = numeric_jacobian(model, sample, 1e-6);
      // 1e-6 squared times third derivatives, plus rounding 1e-16 / 1e-6
      EXPECT_LT((J - numeric).cwiseAbs().maxCoeff(), 1e-8 * TestFixture::unit())
          << "analytic\n"
          << J << "\nnumeric\n"
          << numeric;
    }
  }
}

TYPED_TEST_P(ModelSuite, ResidualIsZeroAtTruth) {
  sim::Random random(12);
  using M = typename TypeParam::Model;
  for (int i = 0; i < 100; ++i) {
    const Sample<M> sample = TypeParam::simulate(random, false);
    Evaluation<M> at;
    ASSERT_TRUE(evaluate(TypeParam::model(), sample.z, sample.x, &at));
    EXPECT_LT(Eigen::VectorXd(at.r).cwiseAbs().maxCoeff(), 1e-12 * TestFixture::unit());
  }
}

TYPED_TEST_P(ModelSuite, NoiseHasTheStatedCovariance) {
  sim::Random random(13);
  using M = typename TypeParam::Model;
  constexpr int kRuns = 20000;
  double sum = 0.0;
  for (int i = 0; i < kRuns; ++i) {
    const Sample<M> sample = TypeParam::simulate(random, true);
    Evaluation<M> at;
    ASSERT_TRUE(evaluate(TypeParam::model(), sample.z, sample.x, &at));
    const Eigen::VectorXd r = at.r;
    sum += r.dot(Eigen::MatrixXd(at.R).llt().solve(r));
  }
  // the mean NIS of n runs has a standard deviation of sqrt(2 dim / n) = 0.01 sqrt(dim); four of
  // these, plus one percent for second-order effects of the angle noise
  EXPECT_NEAR(sum / kRuns, M::kDim, 0.04 * std::sqrt(M::kDim) + 0.01 * M::kDim);
}

TYPED_TEST_P(ModelSuite, NoiseIsSymmetricPositiveDefinite) {
  sim::Random random(14);
  using M = typename TypeParam::Model;
  for (int i = 0; i < 100; ++i) {
    const Sample<M> sample = TypeParam::simulate(random, true);
    Evaluation<M> at;
    ASSERT_TRUE(evaluate(TypeParam::model(), sample.z, sample.x, &at));
    const Eigen::MatrixXd R = at.R;
    EXPECT_EQ(R, R.transpose());
    EXPECT_EQ(R.llt().info(), Eigen::Success);
  }
}

TYPED_TEST_P(ModelSuite, SameResidualWithAndWithoutJacobian) {
  sim::Random random(15);
  using M = typename TypeParam::Model;
  for (int i = 0; i < 100; ++i) {
    const Sample<M> sample = TypeParam::simulate(random, true);
    Evaluation<M> with;
    Evaluation<M> without;
    ASSERT_TRUE(evaluate(TypeParam::model(), sample.z, sample.x, &with, true));
    ASSERT_TRUE(evaluate(TypeParam::model(), sample.z, sample.x, &without, false));
    EXPECT_EQ(Eigen::MatrixXd(with.r), Eigen::MatrixXd(without.r));
    EXPECT_EQ(Eigen::MatrixXd(with.R), Eigen::MatrixXd(without.R));
  }
}

TYPED_TEST_P(ModelSuite, RefusesStatesOutsideItsDomain) {
  sim::Random random(16);
  using M = typename TypeParam::Model;
  const std::optional<Sample<M>> sample = TypeParam::outside(random);
  if (!sample) return;  // defined everywhere
  Evaluation<M> at;
  EXPECT_FALSE(evaluate(TypeParam::model(), sample->z, sample->x, &at));
}

TYPED_TEST_P(ModelSuite, DoesNotAllocate) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  sim::Random random(17);
  using M = typename TypeParam::Model;
  const M model = TypeParam::model();
  const Sample<M> sample = TypeParam::simulate(random, true);
  Evaluation<M> at;
  const AllocationGuard guard;
  EXPECT_TRUE(evaluate(model, sample.z, sample.x, &at));
  EXPECT_EQ(guard.count(), 0);
}

REGISTER_TYPED_TEST_SUITE_P(ModelSuite, JacobianMatchesCentralDifferences, ResidualIsZeroAtTruth,
                            NoiseHasTheStatedCovariance, NoiseIsSymmetricPositiveDefinite,
                            SameResidualWithAndWithoutJacobian, RefusesStatesOutsideItsDomain,
                            DoesNotAllocate);

}  // namespace rio::test
