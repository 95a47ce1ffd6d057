// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/combine_columns.hpp"

#include <cstring>

#if defined(__x86_64__)
#define RIO_HAS_AVX_KERNEL 1
#endif

namespace rio {

namespace {

/// Arguments of combine_columns.
struct Sum {
  std::size_t count;
  const double* const* columns;
  const double* factors;
  double* out;
};

// Registers of doubles. In memory the doubles are not aligned as these: they are copied.
using TwoDoubles = double __attribute__((vector_size(16)));
using FourDoubles = double __attribute__((vector_size(32)));

/// Sums of kPackets registers from `row` on.
template <typename Packet, int kPackets>
[[gnu::always_inline]] inline void add_strip(const Sum& sum, Eigen::Index row) {
  constexpr Eigen::Index kPacket = sizeof(Packet) / sizeof(double);
  Packet total[kPackets] = {};
  for (std::size_t j = 0; j < sum.count; ++j) {
    const double* column = sum.columns[j] + row;
    const double factor = sum.factors[j];
#pragma GCC unroll 8
    for (int i = 0; i < kPackets; ++i) {
      Packet value;
      std::memcpy(&value, column + i * kPacket, sizeof value);
      total[i] += factor * value;
    }
  }
#pragma GCC unroll 8
  for (int i = 0; i < kPackets; ++i) {
    std::memcpy(sum.out + row + i * kPacket, &total[i], sizeof total[i]);
  }
}

/// All rows; the last strip may overlap the one before it.
template <typename Packet>
[[gnu::always_inline]] inline void add_all(const Sum& sum, Eigen::Index rows) {
  constexpr Eigen::Index kPacket = sizeof(Packet) / sizeof(double);
  constexpr Eigen::Index kLong = 8 * kPacket;
  constexpr Eigen::Index kShort = 2 * kPacket;
  Eigen::Index row = 0;
  for (; row + kLong <= rows; row += kLong) add_strip<Packet, 8>(sum, row);
  for (; row + kShort <= rows; row += kShort) add_strip<Packet, 2>(sum, row);
  if (row == rows) return;
  if (rows >= kShort) {
    add_strip<Packet, 2>(sum, rows - kShort);
    return;
  }
  for (; row < rows; ++row) {
    double total = 0.0;
    for (std::size_t j = 0; j < sum.count; ++j) total += sum.factors[j] * sum.columns[j][row];
    sum.out[row] = total;
  }
}

#ifdef RIO_HAS_AVX_KERNEL
[[gnu::target("avx")]] void add_all_avx(const Sum& sum, Eigen::Index rows) {
  add_all<FourDoubles>(sum, rows);
}
#endif

}  // namespace

void combine_columns_baseline(std::size_t count, const double* const* columns,
                              const double* factors, Eigen::Index rows, double* out) {
  add_all<TwoDoubles>({count, columns, factors, out}, rows);
}

void combine_columns(std::size_t count, const double* const* columns, const double* factors,
                     Eigen::Index rows, double* out) {
#ifdef RIO_HAS_AVX_KERNEL
  static const bool has_avx = __builtin_cpu_supports("avx") != 0;
  if (has_avx) {
    add_all_avx({count, columns, factors, out}, rows);
    return;
  }
#endif
  combine_columns_baseline(count, columns, factors, rows, out);
}

}  // namespace rio
