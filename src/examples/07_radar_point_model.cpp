// SPDX-License-Identifier: BSD-3-Clause
// Example 7: a model of radar points of your own, from outside of the library. The weak half of
// each scan is measured by it, the rest by the library's rows; the mounting, configured 3 degrees
// wrong, and the Doppler scale are estimated from both. With either back-end.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <rio/aiding.hpp>
#include <rio/sim/flight.hpp>

namespace {

using rio::Vector3d;

/// Doppler of a static point whose noise grows as its signal weakens.
/// (E1) h = -(1 + s) u^T v_S,  v_S = R_BS^T (R_WB^T v_WB + w x p_BS),  w = gyro - b_g
/// (E2) R = sigma^2 + sigma_u^2 |v_S - u u^T v_S|^2, the noise of the direction included
struct WeakDoppler {
  static constexpr const char* kName = "weak_doppler";
  static constexpr int kDim = 1;
  using Blocks = rio::BlockList<rio::BodyPose, rio::BodyVelocity, rio::GyroBias, rio::Extrinsics,
                                rio::DopplerScale>;
  using Scalar = Eigen::Matrix<double, 1, 1>;
  struct Measurement {
    rio::RadarDetection point;
    Vector3d gyro_B = Vector3d::Zero();  ///< measured at the scan [rad/s]
  };

  double sigma_strong = 0.03;  ///< at an SNR of 20 dB [m/s]
  double sigma_angle = 0.045;  ///< [rad]

  bool evaluate(const Measurement& z, const rio::RigidPose& T_WB, const Vector3d& v_WB,
                const Vector3d& gyro_bias, const rio::RigidPose& T_BS, double scale, Scalar& r,
                Eigen::Matrix<double, 1, 19>* J, Scalar& R) const {
    const Vector3d u = z.point.point_S.normalized();
    const Vector3d w = z.gyro_B - gyro_bias;
    const Vector3d v_B = T_WB.R.transpose() * v_WB;
    const Vector3d v_S = T_BS.R.transpose() * (v_B + w.cross(T_BS.p));
    r[0] = z.point.range_rate + (1.0 + scale) * u.dot(v_S);  // z - (E1)
    if (J != nullptr) {
      const Vector3d scaled_u = (1.0 + scale) * u;
      const Vector3d a = T_BS.R * scaled_u;
      *J << v_B.cross(a).transpose(), 0.0, 0.0, 0.0, -(T_WB.R * a).transpose(),
          T_BS.p.cross(a).transpose(), v_S.cross(scaled_u).transpose(), w.cross(a).transpose(),
          -u.dot(v_S);
    }
    const double sigma = sigma_strong * std::pow(10.0, (20.0 - z.point.snr_db) / 40.0);
    R(0, 0) = sigma * sigma + sigma_angle * sigma_angle * u.cross(v_S).squaredNorm();  // (E2)
    return true;
  }
};

bool fly(const rio::sim::Flight& flight, rio::BackEnd backend, const char* name) {
  rio::Options options;
  options.backend = backend;
  options.radar.T_BS = flight.configured_T_BS;
  std::string why;
  auto odometry = rio::Odometry::create(options, &why);
  if (!odometry) return std::printf("%s\n", why.c_str()), false;
  double nis = 0.0;
  double rows = 0.0;
  std::size_t scan = 0;
  for (const rio::ImuSample& sample : flight.imu) {
    (void)odometry->add_imu(sample);
    for (; scan < flight.scans.size() && flight.scans[scan].time <= sample.time; ++scan) {
      rio::RadarScan rest = flight.scans[scan];
      // the library's rows take what the external model leaves: the strong half first
      const auto weak =
          rest.detections.begin() + static_cast<std::ptrdiff_t>((rest.detections.size() + 1) / 2);
      std::sort(rest.detections.begin(), rest.detections.end(),
                [](const auto& a, const auto& b) { return a.snr_db > b.snr_db; });
      for (auto point = weak; point != rest.detections.end(); ++point) {
        (void)odometry->add_measurement({rest.time, WeakDoppler{}, {*point, sample.gyro_B}});
      }
      rest.detections.erase(weak, rest.detections.end());
      (void)odometry->add_scan(rest);
      for (const rio::InnovationRecord& record : odometry->report().records) {
        if (record.name != WeakDoppler::kName) continue;
        if (record.result != rio::GateResult::kUsed) continue;
        nis += record.nis;
        rows += record.dof;
      }
    }
  }
  const auto angle = [&](const rio::Pose& T_BS) {
    return 57.3 * T_BS.rotation.angularDistance(flight.scenario.radar.T_BS.rotation);
  };
  const double before = angle(flight.configured_T_BS);
  const double after = angle(odometry->extrinsics());
  std::printf(
      "%s: mounting %.1f deg off at the start, %.1f at the end; NIS %.2f over %.0f points\n", name,
      before, after, nis / rows, rows);
  return after < 0.5 * before && rows > 300.0 && std::abs(nis / rows - 1.0) < 0.5;
}

}  // namespace

int main() {
  rio::sim::Scenario scenario;
  scenario.path.length = 60.0;
  scenario.errors.extrinsic_angle = 3.0 / 57.3;
  const rio::sim::Flight flight = rio::sim::simulate_flight(scenario);
  const bool filter = fly(flight, rio::BackEnd::kEkf, "filter");
  const bool window = fly(flight, rio::BackEnd::kSmoother, "window");
  return filter && window ? 0 : 1;
}
