// SPDX-License-Identifier: BSD-3-Clause
// Linear combination of columns, the inner loop of the covariance update.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace rio {

/// out_r <- sum_j factors[j] columns[j]_r for r in [0, rows), each summed in the order of j.
/// Four rows at a time on an x86 processor that has AVX, two elsewhere: chosen when it runs, and
/// with the same bits, for nothing is fused and each row is summed alone. Does not allocate.
/// @param columns,factors arrays of `count`; `out` is none of the columns
void combine_columns(std::size_t count, const double* const* columns, const double* factors,
                     Eigen::Index rows, double* out);

/// The same on every processor: what the bits of combine_columns are compared with.
void combine_columns_baseline(std::size_t count, const double* const* columns,
                              const double* factors, Eigen::Index rows, double* out);

}  // namespace rio
