// SPDX-License-Identifier: BSD-3-Clause
// Filter and smoother on a problem without linearisation: a random chain x' = Phi x + w of body
// states with a constant border and linear measurements of both. The filter (Covariance,
// PanelUpdate) and the sliding window (NormalEquations) give one mean and one covariance.
#include <gtest/gtest.h>

#include "rio/core/mirror.hpp"
#include "rio/ekf/panel_update.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "support/covariance_case.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

constexpr int kBody = body::kSize;
constexpr int kBorder = 8;  // extrinsics, Doppler scale and time offset
constexpr int kTail = kBody + kBorder;
constexpr int kWindow = 3;
constexpr int kSteps = 30;
constexpr int kRows = 8;

/// What happens between two scans, and what the second one measures of [newest state | border].
struct Happening {
  Matrix15d phi;
  Matrix15d noise;
  std::vector<LinearRow> rows;  ///< residual: the measured value
};

LinearRow random_row(sim::Random& random) {
  // position with attitude, velocity, all of the border
  auto rows = linear_rows<1>(random_matrix(random, 1, 6 + 3 + 6 + 1),
                             BlockList<BodyPose, BodyVelocity, Extrinsics, DopplerScale>{},
                             {0, body::kVelocity, kBody, kBody + 6}, random_matrix(random, 1, 1),
                             kBody + 7);
  rows[0].residual = random.normal();
  rows[0].variance = 0.5 + random.uniform();
  return rows[0];
}

Happening random_happening(sim::Random& random) {
  Happening h;
  h.phi = Matrix15d::Identity();
  h.phi.topRows<body::kGyroBias>() += 0.1 * random_matrix(random, body::kGyroBias, 15);
  const MatrixXd L = 0.1 * random_matrix(random, 15, 15);
  h.noise = L * L.transpose() + 1e-2 * Matrix15d::Identity();
  for (int i = 0; i < kRows; ++i) h.rows.push_back(random_row(random));
  return h;
}

/// The mean is that of [newest state | border].
class Filter {
 public:
  explicit Filter(const BodyCovariance& P0)
      : layout_(calibration(), 0, 0), covariance_(layout_), update_(layout_.capacity()) {
    covariance_.reset(P0, parameter_noise(layout_, calibration()).prior);
  }
  static CalibrationOptions calibration() { return {0.5, 0.3, 0.2, 0.2, 0.3}; }
  const Covariance& covariance() const { return covariance_; }
  const VectorXd& mean() const { return mean_; }

  void step(const Happening& h) {
    mean_.head(kBody) = (h.phi * mean_.head(kBody)).eval();
    covariance_.propagate(h.phi, h.noise);
    RowBatch batch(h.rows.size());
    for (LinearRow row : h.rows) {
      row.residual -= (dense_rows(std::array{row}, kTail) * mean_)(0);
      batch.begin_block();
      batch.push(row);
    }
    VectorXd dx(layout_.capacity());
    ASSERT_TRUE(update_.apply(batch, &covariance_, &dx));
    mirror_lower(covariance_.matrix());
    mean_ += dx;
  }

 private:
  Layout layout_;
  Covariance covariance_;
  PanelUpdate update_;
  VectorXd mean_ = VectorXd::Zero(kTail);
};

/// The unknowns are the states themselves: no point of linearisation.
class SlidingWindow {
 public:
  explicit SlidingWindow(const MatrixXd& P0)
      : system_(kWindow + 1, kBorder),
        prior_A_(P0.inverse()),
        prior_g_(VectorXd::Zero(kTail)),
        scans_(1) {}
  const MatrixXd& covariance() const { return covariance_; }
  const VectorXd& mean() const { return mean_; }

  void step(const Happening& h) {
    scans_.push_back(h);
    system_.clear(static_cast<int>(scans_.size()), kBorder);
    system_.add_quadratic(leading_, prior_A_, prior_g_);
    for (std::size_t k = 0; k < scans_.size(); ++k) add(k);
    ASSERT_TRUE(system_.factorise());
    VectorXd x(system_.size());
    system_.solve(&x);
    mean_ = x.tail(kTail);
    ASSERT_TRUE(system_.tail_covariance(&covariance_));
    if (scans_.size() > kWindow) marginalise();
  }

 private:
  void add(std::size_t k) {
    const int state = static_cast<int>(k);
    if (k > 0) {
      const Happening& h = scans_[k];
      NormalEquations::BetweenJacobian J;
      J << -h.phi, Matrix15d::Identity();
      J = whitening(h.noise) * J;
      system_.add_between(state - 1, J, NormalEquations::StateVector::Zero());
    }
    add_rows(k);
  }
  void add_rows(std::size_t k) {
    const int shift = kBody * static_cast<int>(k);
    const int border = kBody * (static_cast<int>(scans_.size()) - 1);
    for (LinearRow row : scans_[k].rows) {
      for (std::size_t s = 0; s < row.segment_count; ++s) {
        row.segments[s].column += row.segments[s].column < kBody ? shift : border;
      }
      system_.add(row);
    }
  }
  void marginalise() {
    system_.clear(static_cast<int>(scans_.size()), kBorder);
    system_.add_quadratic(leading_, prior_A_, prior_g_);
    add_rows(0);
    const Happening& h = scans_[1];
    NormalEquations::BetweenJacobian J;
    J << -h.phi, Matrix15d::Identity();
    J = whitening(h.noise) * J;
    system_.add_between(0, J, NormalEquations::StateVector::Zero());
    MatrixXd A(system_.size(), system_.size());
    VectorXd g(system_.size());
    ASSERT_TRUE(system_.eliminate_oldest(&leading_, &A, &g));
    EXPECT_EQ(leading_, 1);  // only the next state is tied to the oldest
    prior_A_ = A.topLeftCorner(kTail, kTail);
    prior_g_ = g.head(kTail);
    scans_.erase(scans_.begin());
  }

  NormalEquations system_;
  int leading_ = 1;
  MatrixXd prior_A_;
  VectorXd prior_g_;
  std::vector<Happening> scans_;
  MatrixXd covariance_ = MatrixXd::Zero(kTail, kTail);
  VectorXd mean_;
};

TEST(Twin, FilterAndWindowAgreeOnALinearProblem) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    sim::Random random(seed, 1);
    const MatrixXd L = random_matrix(random, 15, 15);
    const BodyCovariance P0 = L * L.transpose() + BodyCovariance(BodyCovariance::Identity());
    Filter filter(P0);
    SlidingWindow window(filter.covariance().matrix());
    for (int step = 0; step < kSteps; ++step) {
      const Happening h = random_happening(random);
      filter.step(h);
      window.step(h);
      const MatrixXd P = filter.covariance().matrix();
      // conditions are below 1e5, so round-off stays some 1e-11
      ASSERT_LE((window.covariance() - P).cwiseAbs().maxCoeff(), 1e-9 * P.cwiseAbs().maxCoeff())
          << "seed " << seed << " step " << step;
      ASSERT_LE((window.mean() - filter.mean()).cwiseAbs().maxCoeff(),
                1e-9 * std::max(1.0, filter.mean().cwiseAbs().maxCoeff()))
          << "seed " << seed << " step " << step;
    }
  }
}

}  // namespace
}  // namespace rio::test
