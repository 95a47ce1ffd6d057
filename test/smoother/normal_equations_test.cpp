// SPDX-License-Identifier: BSD-3-Clause
// The envelope solver against dense matrices of Eigen, on random windows: factorisation, solution,
// covariance of the tail, elimination of the oldest state.
#include "rio/smoother/normal_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "rio/sim/random.hpp"
#include "support/allocation_guard.hpp"

namespace rio::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kState = NormalEquations::kState;
constexpr int kMaxStates = 12;
constexpr int kMaxBorder = 130;
// The condition of the random problems is below 1e6, the round-off of their sums some 1e-16.
constexpr double kRelative = 1e-9;

struct Between {
  int state = 0;
  NormalEquations::BetweenJacobian J;
  NormalEquations::StateVector r;
};
struct Row {
  LinearRow row;
  double weight = 1.0;
};
struct Quadratic {
  int states = 0;
  MatrixXd A = MatrixXd(0, 0);
  VectorXd g = VectorXd(0);
};

/// All that a window knows.
struct Window {
  int states = 0;
  int border = 0;
  std::vector<Row> rows;
  std::vector<Between> chain;
  Quadratic prior;

  int size() const { return kState * states + border; }
  void add_to(NormalEquations* equations) const {
    equations->clear(states, border);
    for (const Row& r : rows) equations->add(r.row, r.weight);
    for (const Between& b : chain) equations->add_between(b.state, b.J, b.r);
    equations->add_quadratic(prior.states, prior.A, prior.g);
  }
};

struct Dense {
  MatrixXd H;
  VectorXd g;
};

VectorXd dense_row(const LinearRow& row, int size) {
  VectorXd h = VectorXd::Zero(size);
  row.for_each_segment([&h](int column, const double* values, int length) {
    for (int i = 0; i < length; ++i) h[column + i] += values[i];
  });
  return h;
}

Dense dense(const Window& window) {
  const int n = window.size();
  Dense d{MatrixXd::Zero(n, n), VectorXd::Zero(n)};
  for (const Row& r : window.rows) {
    const VectorXd h = dense_row(r.row, n);
    d.H += r.weight / r.row.variance * h * h.transpose();
    d.g += r.weight / r.row.variance * r.row.residual * h;
  }
  for (const Between& b : window.chain) {
    MatrixXd J = MatrixXd::Zero(kState, n);
    J.middleCols(kState * b.state, 2 * kState) = b.J;
    d.H += J.transpose() * J;
    d.g -= J.transpose() * b.r;
  }
  const Eigen::Index known = window.prior.A.rows();
  MatrixXd select = MatrixXd::Zero(known, n);
  const int leading = kState * window.prior.states;
  for (Eigen::Index i = 0; i < known; ++i) {
    select(i, i < leading ? i : kState * window.states + i - leading) = 1.0;
  }
  d.H += select.transpose() * window.prior.A * select;
  d.g += select.transpose() * window.prior.g;
  return d;
}

/// What is left when the first `eliminated` unknowns are gone.
Dense schur(const Dense& d, Eigen::Index eliminated) {
  const Eigen::Index rest = d.H.rows() - eliminated;
  const MatrixXd K = d.H.topLeftCorner(eliminated, eliminated)
                         .llt()
                         .solve(d.H.topRightCorner(eliminated, rest))
                         .transpose();
  return {d.H.bottomRightCorner(rest, rest) - K * d.H.topRightCorner(eliminated, rest),
          d.g.tail(rest) - K * d.g.head(eliminated)};
}

void expect_close(const MatrixXd& actual, const MatrixXd& expected, double relative = kRelative) {
  ASSERT_EQ(actual.rows(), expected.rows());
  ASSERT_EQ(actual.cols(), expected.cols());
  if (expected.size() == 0) return;
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), relative * expected.cwiseAbs().maxCoeff());
}

MatrixXd random_matrix(sim::Random& random, Eigen::Index rows, Eigen::Index cols) {
  MatrixXd m(rows, cols);
  for (Eigen::Index c = 0; c < cols; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) m(r, c) = random.normal();
  }
  return m;
}

int random_index(sim::Random& random, int count) {
  return static_cast<int>(random.uniform(0.0, count));
}

Row make_row(sim::Random& random, std::initializer_list<LinearRow::Segment> segments) {
  Row r;
  for (std::size_t i = 0; i < r.row.h.size(); ++i) r.row.h[i] = random.normal();
  for (const LinearRow::Segment& s : segments) {
    if (s.length > 0) r.row.segments[r.row.segment_count++] = s;
  }
  r.row.residual = random.normal();
  r.row.variance = random.uniform(0.5, 2.0);
  r.weight = random.uniform(0.2, 1.0);
  return r;
}

/// A chain of states, a prior, and measurements of one state, of any two states and of the border.
/// @param trails states that are not neighbours are coupled as well
Window random_window(sim::Random& random, int states, int border, bool trails) {
  Window w;
  w.states = states;
  w.border = border;
  const int at = kState * states;
  const auto landmark = [&]() -> LinearRow::Segment {
    const int length = std::min(3, border);
    return {at + random_index(random, border - length + 1), length};
  };
  for (int s = 0; s + 1 < states; ++s) {
    Between b;
    b.state = s;
    b.J = 0.1 * random_matrix(random, kState, 2 * kState);
    b.J.leftCols<kState>().diagonal().array() -= 1.0;
    b.J.rightCols<kState>().diagonal().array() += 1.0;
    b.r = random_matrix(random, kState, 1);
    w.chain.push_back(b);
  }
  for (int i = 0; i < border; ++i) w.rows.push_back(make_row(random, {{at + i, 1}}));
  for (int i = 0; i < 3 * states; ++i) {
    const int s = kState * random_index(random, states);
    w.rows.push_back(make_row(random, {{s, 6}, {s + 6, 3}, landmark()}));
    w.rows.push_back(make_row(random, {landmark(), {s + 9, 3}, landmark()}));
    if (!trails) continue;
    const int other = kState * random_index(random, states);
    const int third = kState * random_index(random, states);
    w.rows.push_back(make_row(random, {{s, 6}, {other, 6}, landmark(), {third + 3, 3}}));
  }
  const int known = trails ? 1 + random_index(random, states) : 1;
  const int n = kState * known + border / 2;  // the landmarks of the second half are new
  const MatrixXd B = 0.1 * random_matrix(random, n, n);
  w.prior = {known, MatrixXd::Identity(n, n) + B * B.transpose(), random_matrix(random, n, 1)};
  return w;
}

std::vector<Window> random_windows() {
  sim::Random random(41);
  std::vector<Window> windows;
  for (int i = 0; i < 100; ++i) {
    windows.push_back(random_window(random, 1 + i % kMaxStates, random_index(random, 61), i % 3));
  }
  return windows;
}

class NormalEquationsTest : public testing::Test {
 protected:
  VectorXd solution() const {
    equations_.solve(&dx_);
    return dx_.head(equations_.size());
  }
  /// Empty if refused.
  MatrixXd tail_covariance() {
    MatrixXd& P = A_;
    if (!equations_.tail_covariance(&P)) return MatrixXd(0, 0);
    return P.topLeftCorner(equations_.tail_size(), equations_.tail_size());
  }
  Quadratic eliminate() {
    int leading = -1;
    EXPECT_TRUE(equations_.eliminate_oldest(&leading, &A_, &dx_));
    const int n = kState * leading + equations_.border();
    return {leading, A_.topLeftCorner(n, n), dx_.head(n)};
  }

  NormalEquations equations_{kMaxStates, kMaxBorder};
  MatrixXd A_ = MatrixXd::Zero(equations_.capacity(), equations_.capacity());
  mutable VectorXd dx_ = VectorXd::Zero(equations_.capacity());
};

TEST_F(NormalEquationsTest, EqualsTheDenseSystem) {
  for (const Window& window : random_windows()) {
    window.add_to(&equations_);
    const Dense d = dense(window);
    expect_close(MatrixXd(equations_.H().selfadjointView<Eigen::Lower>()), d.H);
    expect_close(equations_.g(), d.g);
    ASSERT_TRUE(equations_.factorise());
    expect_close(solution(), d.H.llt().solve(d.g));
    const MatrixXd P = tail_covariance();
    const int tail = equations_.tail_size();
    expect_close(P, d.H.inverse().bottomRightCorner(tail, tail));
    EXPECT_EQ(P, P.transpose());
  }
}

TEST_F(NormalEquationsTest, EliminationEqualsTheSchurComplement) {
  for (const Window& window : random_windows()) {
    window.add_to(&equations_);
    const Dense expected = schur(dense(window), kState);
    ASSERT_TRUE(equations_.factorise());
    const VectorXd before = solution();
    const Quadratic rest = eliminate();
    EXPECT_EQ(rest.states, window.states - 1);  // the chain touches every state
    expect_close(rest.A, expected.H);
    expect_close(rest.g, expected.g);
    EXPECT_EQ(rest.A, rest.A.transpose());
    EXPECT_EQ(solution(), before);  // the factor is still there
  }
}

TEST_F(NormalEquationsTest, DampingIsRelativeToTheDiagonalAndForgotten) {
  sim::Random random(42);
  const Window window = random_window(random, 6, 20, true);
  window.add_to(&equations_);
  const Dense d = dense(window);
  const Dense rest = schur(d, kState);
  for (const double damping : {0.3, 1e3, 0.0}) {
    MatrixXd H = d.H;
    H.diagonal() *= 1.0 + damping;
    ASSERT_TRUE(equations_.factorise(damping));
    expect_close(solution(), H.llt().solve(d.g));
    EXPECT_EQ(tail_covariance().size() == 0, damping > 0.0);  // no covariance of a damped system
    expect_close(eliminate().A, rest.H);                      // never damped
  }
}

TEST_F(NormalEquationsTest, ReportsASystemThatIsNotPositiveDefiniteAndGoesOn) {
  sim::Random random(43);
  const Window window = random_window(random, 5, 12, true);
  Window unseen_landmark = window;
  unseen_landmark.border += 3;
  Window unseen_state = window;
  unseen_state.chain.pop_back();
  unseen_state.rows.clear();
  Window negative = window;
  negative.prior.A(0, 0) = -1e3;
  Window negative_border = window;
  negative_border.prior.A.bottomRightCorner(1, 1).setConstant(-1e3);
  Window broken = window;
  broken.rows.back().row.h[0] = std::numeric_limits<double>::quiet_NaN();
  int number = 0;
  for (const Window& bad : {unseen_landmark, unseen_state, negative, negative_border, broken}) {
    SCOPED_TRACE(number++);
    bad.add_to(&equations_);
    EXPECT_FALSE(equations_.factorise());
    EXPECT_EQ(tail_covariance().size(), 0);
    window.add_to(&equations_);
    ASSERT_TRUE(equations_.factorise());
    const Dense d = dense(window);
    expect_close(solution(), d.H.llt().solve(d.g));
  }
  negative.add_to(&equations_);
  int leading = 0;
  EXPECT_FALSE(equations_.eliminate_oldest(&leading, &A_, &dx_));
}

// The last error of the states is known between them only: the very last pivot is round-off, of
// either sign.
TEST_F(NormalEquationsTest, ReportsAChainWithOneUnknownOrigin) {
  sim::Random random(49);
  for (int i = 0; i < 20; ++i) {
    Window chain = random_window(random, 2 + i % 5, 0, false);
    chain.rows.clear();
    for (Between& b : chain.chain) b.J.leftCols<kState>() = -b.J.rightCols<kState>();
    chain.prior.A.row(kState - 1).setZero();
    chain.prior.A.col(kState - 1).setZero();
    chain.add_to(&equations_);
    EXPECT_FALSE(equations_.factorise());
    EXPECT_TRUE(equations_.factorise(1e-3));  // damping makes it definite
  }
}

bool touches_oldest(const LinearRow& row) {
  bool touches = false;
  row.for_each_segment([&](int column, const double*, int) { touches |= column < kState; });
  return touches;
}

/// The measurements of state 0, and those that stay, numbered without it.
std::pair<Window, Window> split(const Window& window) {
  Window gone = window;
  Window stays = window;
  gone.rows.clear();
  gone.chain.clear();
  stays.rows.clear();
  stays.chain.clear();
  stays.states -= 1;
  stays.prior = {};
  for (const Row& r : window.rows) {
    (touches_oldest(r.row) ? gone : stays).rows.push_back(r);
  }
  for (const Between& b : window.chain) (b.state == 0 ? gone : stays).chain.push_back(b);
  for (Row& r : stays.rows) {
    for (LinearRow::Segment& s : r.row.segments) s.column -= kState;
  }
  for (Between& b : stays.chain) b.state -= 1;
  return {gone, stays};
}

TEST_F(NormalEquationsTest, TheWindowWithoutItsOldestStateHasTheSameSolution) {
  for (const Window& window : random_windows()) {
    if (window.states == 1) continue;
    window.add_to(&equations_);
    ASSERT_TRUE(equations_.factorise());
    const VectorXd full = solution();
    const MatrixXd P = tail_covariance();
    auto [gone, stays] = split(window);
    gone.add_to(&equations_);
    stays.prior = eliminate();
    stays.add_to(&equations_);
    ASSERT_TRUE(equations_.factorise());
    expect_close(solution(), full.tail(stays.size()));
    expect_close(tail_covariance(), P);
  }
}

TEST_F(NormalEquationsTest, OnlyTheMarkovBlanketOfTheOldestStateIsLeft) {
  sim::Random random(44);
  const Window window = split(random_window(random, 7, 9, false)).first;
  window.add_to(&equations_);
  EXPECT_EQ(eliminate().states, 1);
  equations_.add(make_row(random, {{0, 6}, {kState * 4, 6}}).row);
  EXPECT_EQ(eliminate().states, 4);
}

TEST_F(NormalEquationsTest, EliminatingOneStateAfterTheOtherEqualsDense) {
  sim::Random random(45);
  const Window full = random_window(random, kMaxStates, 33, true);
  const Dense expected = schur(dense(full), kState * (full.states - 1));
  Window window = full;
  while (window.states > 1) {
    auto [gone, stays] = split(window);
    gone.add_to(&equations_);
    stays.prior = eliminate();
    window = stays;
  }
  const Dense last = dense(window);
  expect_close(last.H, expected.H);
  expect_close(last.g, expected.g);
  full.add_to(&equations_);
  ASSERT_TRUE(equations_.factorise());
  expect_close(tail_covariance(), last.H.inverse());
}

TEST_F(NormalEquationsTest, TheOrderOfAdditionsDoesNotMatter) {
  sim::Random random(46);
  const Window window = random_window(random, 8, 24, true);
  window.add_to(&equations_);
  NormalEquations other(8, 24);
  other.clear(8, 24);
  other.add_quadratic(window.prior.states, window.prior.A, window.prior.g);
  for (auto b = window.chain.rbegin(); b != window.chain.rend(); ++b) {
    other.add_between(b->state, b->J, b->r);
  }
  for (auto r = window.rows.rbegin(); r != window.rows.rend(); ++r) other.add(r->row, r->weight);
  expect_close(other.H(), equations_.H(), 1e-13);  // sums of some ten terms
  expect_close(other.g(), equations_.g(), 1e-13);
  for (int s = 0; s < 8; ++s) EXPECT_EQ(other.reach(s), equations_.reach(s));
}

TEST_F(NormalEquationsTest, TheEnvelopeFollowsTheMeasurements) {
  sim::Random random(47);
  const auto expect_reach = [this](const std::vector<int>& expected) {
    for (int s = 0; s < equations_.states(); ++s) {
      EXPECT_EQ(equations_.reach(s), expected[static_cast<std::size_t>(s)]) << s;
    }
  };
  equations_.clear(6, 8);
  const int landmark = equations_.border_column();
  equations_.add(make_row(random, {{landmark, 3}, {3 * kState, 6}}).row);
  expect_reach({0, 1, 2, 3, 4, 5});
  random_window(random, 6, 8, false).add_to(&equations_);
  expect_reach({1, 2, 3, 4, 5, 5});
  equations_.add(make_row(random, {{4 * kState, 6}, {landmark, 3}, {kState, 6}}).row);
  expect_reach({1, 4, 4, 4, 5, 5});
  equations_.add_quadratic(4, MatrixXd::Identity(4 * kState, 4 * kState),
                           VectorXd::Zero(4 * kState));
  expect_reach({3, 4, 4, 4, 5, 5});
  equations_.clear(6, 8);
  expect_reach({0, 1, 2, 3, 4, 5});
}

TEST_F(NormalEquationsTest, AllocatesNothing) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  sim::Random random(48);
  for (const bool trails : {false, true}) {
    const Window window = random_window(random, kMaxStates, kMaxBorder, trails);
    int leading = 0;
    const AllocationGuard guard;
    window.add_to(&equations_);
    ASSERT_TRUE(equations_.factorise(0.1));
    ASSERT_TRUE(equations_.factorise());
    equations_.solve(&dx_);
    ASSERT_TRUE(equations_.tail_covariance(&A_));
    ASSERT_TRUE(equations_.eliminate_oldest(&leading, &A_, &dx_));
    const int n = kState * leading + kMaxBorder;
    equations_.clear(kMaxStates - 1, kMaxBorder);
    equations_.add_quadratic(leading, A_.topLeftCorner(n, n), dx_.head(n));
    EXPECT_EQ(guard.count(), 0);
    ASSERT_TRUE(equations_.factorise());
    EXPECT_EQ(guard.count(), 0);
  }
}

}  // namespace
}  // namespace rio::test
