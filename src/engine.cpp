// SPDX-License-Identifier: BSD-3-Clause
#include "engine.hpp"

#include <Eigen/Cholesky>
#include <limits>

namespace rio {

bool ScanQueue::contains(Time time) const {
  for (std::size_t i = 0; i < size_; ++i) {
    if (scans_[i].time == time) return true;
  }
  return false;
}

void ScanQueue::insert(const DetectionList& scan) {
  std::size_t i = size_++;
  for (; i > 0 && scans_[i - 1].time > scan.time; --i) scans_[i] = scans_[i - 1];
  scans_[i] = scan;
}

void ScanQueue::pop_front() {
  for (std::size_t i = 1; i < size_; ++i) scans_[i - 1] = scans_[i];
  --size_;
}

bool is_finite(const NavState& s) {
  return s.q_WB.coeffs().allFinite() && s.p_WB.allFinite() && s.v_WB.allFinite() &&
         s.gyro_bias.allFinite() && s.accel_bias.allFinite();
}

bool is_covariance(const BodyCovariance& P) {
  const double scale = P.cwiseAbs().maxCoeff();
  if ((P - P.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale) return false;
  Matrix15d above = P;  // no eigenvalue below -1e-9 scale: this has a Cholesky factor
  above.diagonal().array() += 1e-9 * scale + std::numeric_limits<double>::min();
  return Eigen::LLT<Matrix15d>(above).info() == Eigen::Success;
}

}  // namespace rio
