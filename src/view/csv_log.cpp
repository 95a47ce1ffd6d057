// SPDX-License-Identifier: BSD-3-Clause
#include "view/csv_log.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "view/calibration_names.hpp"

namespace rio::view {

namespace {

/// The folder, there afterwards.
std::filesystem::path made(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

std::string cell(const Vector3d& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}
template <class Value>
std::string cell(const Value& value) {
  return fmt::format("{}", value);
}

/// A row: its head, and the cells of all values.
template <class... Values>
void write(io::TextFile* file, const std::string& head, const Values&... values) {
  std::string line = head;
  (line.append(",").append(cell(values)), ...);
  file->write(line + "\n");
}

constexpr const char* kGateResults[] = {"used", "gated", "out of domain"};  // GateResult

}  // namespace

CsvLog::CsvLog(const std::filesystem::path& folder)
    : scans_(made(folder) / kLogFiles[0]),
      innovations_(folder / kLogFiles[1]),
      points_(folder / kLogFiles[2]),
      landmarks_(folder / kLogFiles[3]),
      calibration_(folder / kLogFiles[4]),
      health_(folder / kLogFiles[5]),
      events_(folder / kLogFiles[6]) {
  const std::string head = "t_ns,stamp_ns,radar,";
  scans_.write(
      head +
      "p_x_m,p_y_m,p_z_m,q_w,q_x,q_y,q_z,v_x_mps,v_y_mps,v_z_mps,"
      "bg_x_radps,bg_y_radps,bg_z_radps,ba_x_mps2,ba_y_mps2,ba_z_mps2,"
      "sigma_p_x_m,sigma_p_y_m,sigma_p_z_m,sigma_phi_x_rad,sigma_phi_y_rad,sigma_phi_z_rad,"
      "sigma_v_x_mps,sigma_v_y_mps,sigma_v_z_mps,points,points_kept,points_static,"
      "ego_v_x_mps,ego_v_y_mps,ego_v_z_mps,landmarks,landmarks_matched,clones,at_rest,"
      "update_ms,propagation_ms\n");
  innovations_.write(head + "model,name,point,rows,innovation,sigma,nis,gate,result\n");
  points_.write(head +
                "point,label,S_x_m,S_y_m,S_z_m,W_x_m,W_y_m,W_z_m,range_rate_mps,snr_db,"
                "residual_mps,residual_sigma_mps\n");
  landmarks_.write(head +
                   "W_x_m,W_y_m,W_z_m,P_xx_m2,P_xy_m2,P_xz_m2,P_yy_m2,P_yz_m2,P_zz_m2,"
                   "last_seen_ns\n");
  calibration_.write(head + "parameter,unit,correction,sigma,prior_sigma,observability\n");
  health_.write(head + "state,position,velocity,heading,quality,reset_counter");
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    std::string reason = rio::to_string(static_cast<HealthReason>(i));
    std::replace(reason.begin(), reason.end(), ' ', '_');
    health_.write("," + reason);
  }
  health_.write("\n");
  events_.write("t_ns,kind,serious,text\n");
}

void CsvLog::add(const Odometry& odometry) {
  const NavState& x = odometry.at_scan();
  const BodyCovariance& P = odometry.covariance();
  const UpdateReport& r = odometry.report();
  const std::string head = fmt::format("{},{},{}", x.time.count(), r.time.count(), r.radar);
  const Quaternion& q = x.q_WB;
  write(&scans_, head, x.p_WB, q.w(), q.x(), q.y(), q.z(), x.v_WB, x.gyro_bias, x.accel_bias,
        sigma_of(P, body::kPosition), sigma_of(P, body::kAttitude), sigma_of(P, body::kVelocity),
        r.detections, r.detections_kept, r.static_detections,
        r.ego_velocity_valid ? cell(r.ego_velocity_S) : ",,", r.landmarks, r.landmarks_matched,
        r.clones, r.at_rest ? 1 : 0, 1e3 * to_seconds(r.update_time),
        1e3 * to_seconds(r.propagation_time));
  for (const InnovationRecord& i : r.records) {
    write(&innovations_, head, rio::to_string(i.model), i.name == nullptr ? "" : i.name,
          i.detection, i.dof, i.innovation, i.sigma, i.nis, i.gate,
          kGateResults[static_cast<std::size_t>(i.result)]);
  }
  std::size_t point = 0;
  for (const PointReport& p : odometry.points()) {
    write(&points_, head, point++, rio::to_string(p.label), p.point_S, p.point_W, p.range_rate,
          p.snr_db, p.residual, p.residual_sigma);
  }
  for (const LandmarkReport& l : odometry.landmarks()) {
    const Matrix3d& C = l.covariance_W;
    write(&landmarks_, head, l.position_W, C(0, 0), C(0, 1), C(0, 2), C(1, 1), C(1, 2), C(2, 2),
          l.last_seen.count());
  }
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const CalibrationReport& c = r.calibration[i];
    if (c.observability == Observability::kNotEstimated) continue;
    write(&calibration_, head, calibration_name(i, r.radar), kCalibrationNames[i].si_unit, c.value,
          c.sigma, c.prior_sigma, rio::to_string(c.observability));
  }
  const Health& h = r.health;
  write(&health_, head, rio::to_string(h.state), rio::to_string(h.position),
        rio::to_string(h.velocity), rio::to_string(h.heading), h.quality, h.reset_counter,
        fmt::format("{}", fmt::join(h.severity, ",")));
}

void CsvLog::add_event(const Event& event) {
  write(&events_, cell(event.time.count()), kEventNames[static_cast<std::size_t>(event.kind)],
        event.serious ? 1 : 0, "\"" + event.text + "\"");
}

void CsvLog::close() {
  for (io::TextFile* file :
       {&scans_, &innovations_, &points_, &landmarks_, &calibration_, &health_, &events_}) {
    file->close();
  }
}

}  // namespace rio::view
