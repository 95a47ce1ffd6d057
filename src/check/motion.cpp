// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "rio/core/small_cholesky.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

/// (E3) of [a r, p], before the elimination of (E7).
struct WithLever {
  Eigen::Matrix<double, 12, 12> A = Eigen::Matrix<double, 12, 12>::Zero();
  Eigen::Matrix<double, 12, 1> b = Eigen::Matrix<double, 12, 1>::Zero();
  double c = 0.0;
  double weight = 0.0;
  std::size_t windows = 0;
  int scans = 0;

  void add(const WithLever& other) {
    A += other.A;
    b += other.b;
    c += other.c;
    weight += other.weight;
    windows += other.windows;
    scans += other.scans;
  }

  /// (E7)
  /// @param sigma of p, per axis [m]
  Agreement without_lever(double sigma) const;
};

/// Sums of (E3) over the scans of a window: over w times products of
/// G = [y_x C, y_y C, y_z C, -C [w]x], q, 1 and t.
struct Sums {
  using Map12 = Eigen::Matrix<double, 3, 12>;
  int scans = 0;
  double last = 0.0;                  ///< t of the last scan [s]
  Vector3d begin = Vector3d::Zero();  ///< s at the first one [m/s]
  double w = 0.0;
  double wt = 0.0;
  double wtt = 0.0;
  double qq = 0.0;
  Vector3d q = Vector3d::Zero();
  Vector3d tq = Vector3d::Zero();
  Matrix3d yy = Matrix3d::Zero();
  Matrix3d Cq_y = Matrix3d::Zero();    ///< column-wise the first nine of G^T q
  Vector3d Lq = Vector3d::Zero();      ///< the others
  Matrix3d rate_y = Matrix3d::Zero();  ///< of rate and y
  Matrix3d rates = Matrix3d::Zero();   ///< of rate and rate
  Map12 G = Map12::Zero();
  Map12 tG = Map12::Zero();

  void add(double t, double weight, const Vector3d& y, const Matrix3d& C, const Vector3d& rate,
           const Vector3d& value) {
    const Vector3d wy = weight * y;
    ++scans;
    last = t;
    w += weight;
    wt += weight * t;
    wtt += weight * t * t;
    qq += weight * value.squaredNorm();
    q += weight * value;
    tq += weight * t * value;
    yy += wy * y.transpose();
    const Vector3d value_B = C.transpose() * value;
    Cq_y += value_B * wy.transpose();
    Lq += weight * rate.cross(value_B);
    rate_y += rate * wy.transpose();
    rates += weight * rate * rate.transpose();
    const Matrix3d of_lever = -weight * C * skew(rate);
    G.rightCols<3>() += of_lever;
    tG.rightCols<3>() += t * of_lever;
    for (int k = 0; k < 3; ++k) {
      const Matrix3d part = wy[k] * C;
      G.block<3, 3>(0, 3 * k) += part;
      tG.block<3, 3>(0, 3 * k) += t * part;
    }
  }

  /// Subtracts the lines over t, as normal equations: with N the inverse of [w, wt; wt, wtt], the
  /// products of the lines of a and b are [sum a, sum ta]^T N [sum b, sum tb].
  WithLever less_lines() const {
    WithLever out;
    const double det = w * wtt - wt * wt;
    const Map12 start = (wtt * G - wt * tG) / det;
    const Map12 slope = (w * tG - wt * G) / det;
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        out.A.block<3, 3>(3 * j, 3 * k).diagonal().setConstant(yy(j, k));
      }
      const Matrix3d cross = -skew(rate_y.col(j));
      out.A.block<3, 3>(3 * j, 9) = cross;
      out.A.block<3, 3>(9, 3 * j) = cross.transpose();
    }
    out.A.bottomRightCorner<3, 3>() = rates.trace() * Matrix3d::Identity() - rates;
    out.A -= G.transpose() * start + tG.transpose() * slope;
    out.b << Eigen::Map<const Eigen::Matrix<double, 9, 1>>(Cq_y.data()), Lq;
    out.b -= start.transpose() * q + slope.transpose() * tq;
    out.c = qq - (q.dot(wtt * q - wt * tq) + tq.dot(w * tq - wt * q)) / det;
    out.weight = w;
    out.windows = 1;
    out.scans = scans;
    return out;
  }
};

Agreement WithLever::without_lever(double sigma) const {
  Agreement out;
  out.moved = c;
  out.weight = weight;
  out.windows = windows;
  if (windows == 0) return out;
  // as in (E6) the scans of a window count as one
  const double prior = kModels * kModels / (sigma * sigma) * scans / static_cast<double>(windows);
  const Matrix3d inverse =
      SmallCholesky<3>(A.bottomRightCorner<3, 3>() + prior * Matrix3d::Identity()).inverse();
  const Eigen::Matrix<double, 3, 9> gain = inverse * A.bottomLeftCorner<3, 9>();
  const Vector3d p = inverse * b.tail<3>();
  out.A = A.topLeftCorner<9, 9>() - gain.transpose() * A.bottomLeftCorner<3, 9>();
  out.b = b.head<9>() - gain.transpose() * b.tail<3>();
  out.c = c - p.dot(b.tail<3>());
  return out;
}

}  // namespace

double Agreement::explained(const Matrix3d& R) const {
  const double along = b.dot(R.reshaped());  // column-wise
  const double moves = square(R);
  return c > 0.0 && along > 0.0 && moves > 0.0 ? along * along / (c * moves) : 0.0;
}

double Agreement::square(const Matrix3d& R) const {
  return R.reshaped().dot(A * R.reshaped());
}

double Agreement::movement() const {
  // mean of r^T A r over all rotations r
  return weight > 0.0 ? std::sqrt(A.trace() / (3.0 * weight)) : 0.0;
}

double Agreement::movement_of_imu() const {
  return weight > 0.0 ? std::sqrt(moved / weight) : 0.0;
}

std::vector<Agreement> agreements(const std::vector<RadarSpeed>& speeds, const ImuPath& path,
                                  double length, const RadarOptions& radar,
                                  const std::vector<double>& shifts) {
  constexpr int kFewest = 8;           // besides the six unknowns of v_0 and g
  constexpr double kUnmeasured = 0.2;  // an arm that nobody configured, of a small robot [m]
  constexpr double kMeasured = 0.03;   // by a ruler [m]
  constexpr double kShortest = 0.5;    // of the length
  const Vector3d& lever_B = radar.T_BS.translation;
  std::vector<WithLever> all(shifts.size());
  std::vector<Sums> sums(shifts.size());
  Time begin{0};
  int piece = 0;
  const auto close = [&] {
    for (std::size_t s = 0; s < shifts.size(); ++s) {
      if (sums[s].scans >= kFewest && sums[s].last >= kShortest * length) {
        all[s].add(sums[s].less_lines());
      }
      sums[s] = Sums();
    }
  };
  for (const RadarSpeed& speed : speeds) {
    const auto first = path.at(speed.time - from_seconds(kMostShift));
    const auto last = path.at(speed.time + from_seconds(kMostShift));
    if (!first || !last || first->piece != last->piece) continue;
    const double since = to_seconds(speed.time - begin);
    const bool some = sums.front().scans > 0;
    if (some && (since > length || since < 0.0 || first->piece != piece)) close();
    const bool opens = sums.front().scans == 0;
    if (opens) begin = speed.time;
    piece = first->piece;
    for (std::size_t s = 0; s < shifts.size(); ++s) {
      const ImuPath::Point p = *path.at(speed.time + from_seconds(shifts[s] - radar.time_offset));
      if (opens) sums[s].begin = p.sum;
      const Matrix3d C = p.turn.toRotationMatrix();
      sums[s].add(to_seconds(speed.time - begin), speed.weight, speed.v_S, C, p.rate,
                  p.sum - sums[s].begin + C * p.rate.cross(lever_B));
    }
  }
  close();
  std::vector<Agreement> out;
  const double sigma = lever_B.isZero() ? kUnmeasured : kMeasured;
  for (const WithLever& windows : all) out.push_back(windows.without_lever(sigma));
  return out;
}

double movement_of(const std::vector<ImuSample>& samples, double gyro_unit, double accel_unit) {
  constexpr double kPeriod = 0.1;  // ten of them in a window at least [s]
  constexpr double kLength = 2.0;  // [s]
  std::vector<RadarSpeed> times;
  for (const ImuSample& s : samples) {
    if (!times.empty() && to_seconds(s.time - times.back().time) < kPeriod) continue;
    times.emplace_back();
    times.back().time = s.time;
  }
  const ImuPath path(samples, gyro_unit, accel_unit);
  return agreements(times, path, kLength, RadarOptions()).front().movement_of_imu();
}

FittedRotation fitted_rotation(const Agreement& all, const Matrix3d& R) {
  constexpr int kSteps = 20;
  constexpr double kSettled = 1e-6;  // [rad]
  FittedRotation out{R, 0.0};
  double scale = all.b.dot(R.reshaped()) / all.square(R);  // a
  Eigen::Matrix4d H;                                       // by phi and ln a
  for (int i = 0; i < kSteps; ++i) {
    Eigen::Matrix<double, 9, 4> by;
    for (int k = 0; k < 3; ++k) by.col(k) = (scale * out.R * skew(Vector3d::Unit(k))).reshaped();
    by.col(3) = scale * out.R.reshaped();
    H = by.transpose() * all.A * by;
    const Eigen::Vector4d step = H.ldlt().solve(by.transpose() * (all.b - all.A * by.col(3)));
    const Matrix3d next = out.R * quaternion_exp(Vector3d(step.head<3>())).toRotationMatrix();
    if (!(all.explained(next) >= all.explained(out.R))) break;
    out.R = next;
    scale = all.b.dot(next.reshaped()) / all.square(next);
    if (step.norm() < kSettled) break;
  }
  const double unexplained = all.c * (1.0 - all.explained(out.R));
  const Matrix3d covariance = unexplained / (3.0 * static_cast<double>(all.windows)) *
                              H.ldlt().solve(Eigen::Matrix4d::Identity()).topLeftCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  out.sigma = std::sqrt(axes.eigenvalues()[2]);
  return out;
}

double significance(double worse, double better, std::size_t windows) {
  constexpr double kNoBetter = 1e-3;  // no recording agrees better
  const double gain = std::max(0.0, better - worse);
  return std::sqrt(3.0 * static_cast<double>(windows) * gain / std::max(kNoBetter, 1.0 - better));
}

}  // namespace rio::check
