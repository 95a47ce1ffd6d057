// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/combine_columns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "rio/sim/random.hpp"

namespace rio::test {
namespace {

TEST(CombineColumns, EachRowIsTheSumInOrderToTheLastBit) {
  constexpr double kUntouched = 7.0;
  sim::Random random(4);
  const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(80, 9, [&] { return random.normal(); });
  for (Eigen::Index rows = 0; rows <= 70; ++rows) {
    for (const std::size_t count : {0U, 1U, 2U, 9U}) {
      std::vector<const double*> columns;
      std::vector<double> factors;
      for (std::size_t j = 0; j < count; ++j) {
        columns.push_back(&A(3, static_cast<Eigen::Index>(j)));  // anywhere in memory
        factors.push_back(random.normal());
      }
      Eigen::VectorXd expected = Eigen::VectorXd::Constant(72, kUntouched);
      for (Eigen::Index r = 0; r < rows; ++r) {
        expected[r] = 0.0;
        for (std::size_t j = 0; j < count; ++j) {
          const volatile double product = factors[j] * columns[j][r];
          expected[r] += product;
        }
      }
      Eigen::VectorXd out = Eigen::VectorXd::Constant(72, kUntouched);
      combine_columns(count, columns.data(), factors.data(), rows, out.data());
      EXPECT_EQ(out, expected) << rows << " rows, " << count << " columns";
      out.setConstant(kUntouched);
      combine_columns_baseline(count, columns.data(), factors.data(), rows, out.data());
      EXPECT_EQ(out, expected) << rows << " rows, " << count << " columns, without AVX";
    }
  }
}

}  // namespace
}  // namespace rio::test
