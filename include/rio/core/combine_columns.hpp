// SPDX-License-Identifier: BSD-3-Clause
// Linear combination of columns, the inner loop of the covariance update.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace rio {

/// out_r <- sum_j factors[j] columns[j]_r for r in [0, rows), each summed in the order of j.
/// Packets of four rows on an x86 processor with AVX, of two elsewhere, chosen at run time. Both
/// give the same bits: no multiply-add is fused and each row is summed alone. Does not allocate.
/// @param columns,factors arrays of `count` elements; `out` must not overlap a column
void combine_columns(std::size_t count, const double* const* columns, const double* factors,
                     Eigen::Index rows, double* out);

/// Same result by packets of two rows on every processor: the reference for tests.
void combine_columns_baseline(std::size_t count, const double* const* columns,
                              const double* factors, Eigen::Index rows, double* out);

}  // namespace rio
