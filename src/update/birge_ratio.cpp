// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/birge_ratio.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

double BirgeRatio::add(Time time, double value, double sigma, double walk) {
  // longer than most reflectors stay in view
  constexpr Time kInterval{2'000'000'000};
  // of P-: less is a rest, and the interval continues
  constexpr double kInformative = 0.01;
  // while P is wide D is the error of the prior, which has its own check (Observability::kDoubtful)
  constexpr double kDetermined = 0.5;
  // intervals with a ratio of 1, assumed before the first
  constexpr int kConsistent = 4;
  const double walked = walk * to_seconds(time - begin_.time);
  const double fall = begin_.sigma * begin_.sigma + walked - sigma * sigma;  // (E1)
  widest_ = std::max(widest_, sigma);
  if (begin_.sigma == 0.0 || fall < 0.0) {  // first estimate, or a wider prior
    begin_ = {time, value, sigma};
  } else if (time - begin_.time >= kInterval &&
             fall >= kInformative * begin_.sigma * begin_.sigma) {
    if (begin_.sigma <= kDetermined * widest_) {
      const double correction = value - begin_.value;
      sum_ += correction * correction / fall;
      ++intervals_;
    }
    begin_ = {time, value, sigma};
  }
  return std::sqrt(std::max(1.0, (kConsistent + sum_) / (kConsistent + intervals_)));
}

}  // namespace rio
