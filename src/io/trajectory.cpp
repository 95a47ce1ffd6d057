// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/trajectory.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "decimal.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/io/csv.hpp"
#include "rio/io/dataset.hpp"

namespace rio::io {

namespace {

constexpr const char* kColoradarPoses = "groundtruth/groundtruth_poses.txt";
constexpr std::size_t kPositions = 4;  // columns of a file without attitudes

/// Decimal seconds, or integer nanoseconds of our time.
Time stamp_at(const CsvReader& rows) {
  constexpr std::size_t kDigits = 15;
  const std::string_view text = rows.cell(0);
  const bool ns = text.size() >= kDigits && text.find_first_not_of("0123456789") == text.npos;
  return Time(ns ? rows.integer(0) : rows.seconds_to_ns(0));
}

/// In the columns from `first` on, qx qy qz qw.
Quaternion attitude_at(const CsvReader& rows, std::size_t first) {
  const auto q = unit_quaternion(rows.number(first + 3), rows.number(first), rows.number(first + 1),
                                 rows.number(first + 2));
  if (!q) rows.fail("not a unit quaternion");
  return *q;
}

/// Rows without stamps have them in timestamps.txt beside the file.
Trajectory read_tum(const std::filesystem::path& path, TumOrder order, Attitude attitude,
                    char separator = ' ') {
  CsvReader rows(path, separator);
  rows.expect_names({"timestamp", "px", "py", "pz", "qx", "qy", "qz", "qw"});
  std::optional<CsvReader> stamps;
  Trajectory trajectory;
  while (rows.next()) {
    const std::size_t columns = rows.columns();
    const std::filesystem::path beside = path.parent_path() / "timestamps.txt";
    if (columns == 7 && !stamps && std::filesystem::exists(beside)) stamps.emplace(beside, ' ');
    if (columns == 1) (void)rows.number(0);  // names another separator
    const bool positions = columns == kPositions && attitude == Attitude::kOptional;
    if (columns != 8 && !stamps && !positions) {
      const char* known = columns == 12 ? "; poses of KITTI have no stamps"
                          : columns == kPositions
                              ? "; positions alone are a truth for rio evaluate only"
                              : "";
      rows.fail(fmt::format("has {} columns, a TUM file has 8{}", columns, known));
    }
    if (stamps && !stamps->next()) rows.fail("has no stamp in " + beside.string());
    const std::size_t i = stamps ? 0 : 1;
    StampedPose pose;
    pose.time = stamp_at(stamps ? *stamps : rows);
    pose.p = Vector3d(rows.number(i), rows.number(i + 1), rows.number(i + 2));
    if (!pose.p.allFinite()) rows.fail("position is not finite");
    if (positions) {
      pose.q.coeffs().setConstant(std::numeric_limits<double>::quiet_NaN());
    } else {
      pose.q = attitude_at(rows, i + 3);
    }
    if (order == TumOrder::kStrict && !trajectory.empty() && pose.time <= trajectory.back().time) {
      rows.fail("time does not increase: rows to be sorted, or two paths in one file");
    }
    trajectory.push_back(pose);
  }
  if (trajectory.empty()) throw std::runtime_error(path.string() + ": holds no poses");
  if (order == TumOrder::kSorted) return eval::sorted_without_duplicates(std::move(trajectory));
  return trajectory;
}

/// Of a TUM file, whose stamps are in seconds if commas separate eight columns; else empty.
std::optional<char> tum_separator(const std::filesystem::path& path) {
  CsvReader rows(path);
  if (!rows.next() || rows.columns() == 1) return ' ';
  if (rows.columns() == kPositions) return ',';
  const bool seconds = rows.cell(0).find_first_of(".eE") != std::string_view::npos;
  return rows.columns() == 8 && seconds ? std::optional(',') : std::nullopt;
}

}  // namespace

std::string seconds_text(Time time) {
  const Time::rep ns = time.count();
  const auto magnitude =
      ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  return fmt::format("{}{}.{:09}", ns < 0 ? "-" : "", magnitude / 1000000000U,
                     magnitude % 1000000000U);
}

std::string tum_line(const StampedPose& pose) {
  return fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", seconds_text(pose.time),
                     pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(),
                     pose.q.w());
}

void write_tum(const std::filesystem::path& path, const Trajectory& trajectory) {
  TextFile file(path);
  for (const StampedPose& pose : trajectory) file.write(tum_line(pose) + "\n");
  file.close();
}

Trajectory read_trajectory(const std::filesystem::path& path, TumOrder order, Attitude attitude) {
  if (std::filesystem::exists(path / kColoradarPoses)) {
    return read_tum(path / kColoradarPoses, order, attitude);
  }
  if (!std::filesystem::is_directory(path)) {
    const std::optional<char> separator = tum_separator(path);
    if (separator) return read_tum(path, order, attitude, *separator);
  }
  Trajectory trajectory;
  for (const NavState& state : read_ground_truth(path)) {
    trajectory.push_back({state.time, state.p_WB, state.q_WB});
  }
  return trajectory;
}

StateCovariance state_covariance(const BodyCovariance& covariance) {
  constexpr std::array<int, 3> kOrder = {body::kPosition, body::kAttitude, body::kVelocity};
  StateCovariance P;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      P.block<3, 3>(3 * i, 3 * j) = covariance.block<3, 3>(kOrder[static_cast<std::size_t>(i)],
                                                           kOrder[static_cast<std::size_t>(j)]);
    }
  }
  return P;
}

StatesFile::StatesFile(const std::filesystem::path& path) : file_(path) {
  std::string header = "#t_ns,px_m,py_m,pz_m,qw,qx,qy,qz,vx_mps,vy_mps,vz_mps";
  // position and velocity in world axes [m, m/s], attitude error about body axes [rad]
  constexpr std::array kErrors = {"px", "py", "pz", "thx", "thy", "thz", "vx", "vy", "vz"};
  for (std::size_t i = 0; i < kErrors.size(); ++i) {
    for (std::size_t j = i; j < kErrors.size(); ++j) {
      header += fmt::format(",P_{}_{}", kErrors[i], kErrors[j]);
    }
  }
  file_.write(header + ",bgx_radps,bgy_radps,bgz_radps,bax_mps2,bay_mps2,baz_mps2\n");
}

void StatesFile::add(const NavState& state, const BodyCovariance& covariance) {
  std::string row = fmt::format("{}", state.time.count());
  const auto append = [&row](double value) { row += fmt::format(",{}", value); };
  const auto append_vector = [&append](const Vector3d& v) {
    for (int i = 0; i < 3; ++i) append(v[i]);
  };
  append_vector(state.p_WB);
  append(state.q_WB.w());
  append_vector(state.q_WB.vec());
  append_vector(state.v_WB);
  const StateCovariance P = state_covariance(covariance);
  for (int i = 0; i < 9; ++i) {
    for (int j = i; j < 9; ++j) append(P(i, j));
  }
  append_vector(state.gyro_bias);
  append_vector(state.accel_bias);
  file_.write(row + "\n");
}

PathFiles::PathFiles(const std::string& tum, const std::string& states) {
  if (!tum.empty()) tum_.emplace(tum);
  if (!states.empty()) states_.emplace(states);
}

void PathFiles::add(const NavState& state, const BodyCovariance& covariance) {
  if (newest_ && newest_->first.time != state.time) write();
  newest_.emplace(state, covariance);
}

void PathFiles::write() {
  const auto& [x, covariance] = *newest_;
  if (tum_) tum_->write(tum_line({x.time, x.p_WB, x.q_WB}) + "\n");
  if (states_) states_->add(x, covariance);
}

void PathFiles::close() {
  if (newest_) write();
  if (tum_) tum_->close();
  if (states_) states_->close();
}

}  // namespace rio::io
