// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion_check.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "check/numbers.hpp"
#include "rio/core/so3.hpp"
#include "rio/frontend/mounting_search.hpp"

namespace rio::check {

Matrix3d best_rotation(const Agreement& all, double sign, Vector3d* strongest) {
  const Eigen::JacobiSVD<Matrix3d> svd(Eigen::Map<const Matrix3d>(all.b.data()),
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (strongest != nullptr) *strongest = svd.matrixV().col(0);
  const double handed = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3d(1.0, 1.0, sign * handed).asDiagonal() * svd.matrixV().transpose();
}

namespace {

/// The best_rotation() without and with the Doppler flipped, if they are far from all right angles
/// and clearly better.
void append_any_angle(const Judge& judge, std::vector<Axes>* list) {
  constexpr double kFar = 20.0 * kDegree;
  const std::vector<Axes> right = *list;
  for (const double sign : {1.0, -1.0}) {
    Vector3d strongest;
    const Matrix3d R = best_rotation(judge.all, sign, &strongest);
    const double explained = judge.all.explained(R);
    const bool better = std::none_of(right.begin(), right.end(), [&](const Axes& axes) {
      const bool same_hand = axes.R.determinant() * R.determinant() > 0.0;
      return (same_hand && angle_between(axes.R, R) < kFar) ||
             significance(judge.all.explained(axes.R), explained, judge.all.windows) < kSignificant;
    });
    if (!better || explained < kExplained) continue;
    const Matrix3d turned = R * quaternion_exp(90.0 * kDegree * strongest).toRotationMatrix();
    const bool shown = judge.doubt(turned, R) > kSignificant;
    list->push_back({R, sign < 0.0, angle_between(judge.configured, sign * R),
                     shown ? Vector3d(Vector3d::Zero()) : strongest});
  }
}

/// All candidates that the sign of the Doppler allows.
std::vector<Axes> hypotheses(const Judge& judge) {
  std::vector<Axes> list = candidates(judge.options.radar.T_BS.rotation);
  append_any_angle(judge, &list);
  std::erase_if(list, [&judge](const Axes& axes) {
    return !allowed(axes, judge.configured, judge.data.doppler_sign);
  });
  return list;
}

/// The rotation by right angles near that of the mounting, if there is one.
std::string right_angle_text(const Matrix3d& R) {
  constexpr double kNear = 20.0 * kDegree;
  for (const Matrix3d& P : right_angles()) {
    if (angle_between(P, R) > kNear) continue;
    const double turn = angle_between(P, Matrix3d::Identity());
    return turn < 1e-6 ? "; here the radar seems to have the axes of the body"
                       : "; here it seems that " + describe(Matrix3d::Identity(), {P, false, turn},
                                                            DopplerSign::kUnknown);
  }
  return "";
}

/// The other sign of the Doppler, although the ranges show the configured one.
bool inverts_the_accelerometer(const Judge& judge, const Axes& axes) {
  return axes.doppler_flipped && axes.turn < 1e-6 &&
         judge.data.doppler_sign == DopplerSign::kAsConfigured;
}

/// Root mean square [m/s].
double usual_speed(const std::vector<RadarSpeed>& speeds) {
  double sum = 0.0;
  for (const RadarSpeed& speed : speeds) sum += speed.v_S.squaredNorm();
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, speeds.size())));
}

/// The best explains little: is there no movement to explain, or another error?
void say_nothing_explains(const Judge& judge, double best, Finding* out) {
  constexpr double kMuch = 0.1;    // [m/s]
  constexpr double kClear = 2.0;   // times the noise
  constexpr double kStill = 3.0;   // same, of a velocity that is hardly any
  constexpr double kLess = 0.8;    // of what the IMU measures
  constexpr double kChance = 0.1;  // explained
  constexpr double kUnseen = 0.1;  // by a bias of 4 deg/s in the shortest windows [m/s]
  const double movement = judge.all.movement();
  const double of_imu = judge.all.movement_of_imu();
  const double of_speeds = noise(judge.data.speeds);
  const double speed = usual_speed(judge.data.speeds);
  out->text += fmt::format(
      ", at best {:.0f} % with any other; the velocity of the radar changes by {:.2f} m/s (rms, "
      "noise {:.2f})",
      100.0 * best, movement, of_speeds);
  // noise of the accelerometer grows with the root of the window, what a bias of the gyro makes of
  // gravity with its square
  const double no_motion = kUnseen * std::pow(judge.length / kShortestWindow, 1.5);
  const bool flown = speed > 0.0 && of_imu > no_motion;
  if (flown && speed < kStill * of_speeds && speed < kLess * of_imu) {
    *out = compensated(
        judge, out->text + fmt::format(" and is {:.2f} m/s (rms), while that of the IMU changes by "
                                       "{:.2f}: the Doppler does not show the motion of the radar",
                                       speed, of_imu));
    return;
  }
  // of a standing vehicle the radar sees what moves around it
  const bool clear = flown && of_imu > kClear * of_speeds && best < kChance;
  if (!clear && (movement < kMuch || movement < kClear * of_speeds || of_imu < kMuch)) {
    out->text += ": the motion does not tell";
    return;
  }
  out->judge(Verdict::kDoubtful, ": no mounting explains it",
             "look at the axes of the IMU (swapped columns, a left-handed axis), the clocks, the "
             "fields of the points, and whether most of them move");
}

/// A mounting by right angles stays as it is if the motion shows no other significantly.
FittedRotation proposed_mounting(const Judge& judge, const Matrix3d& R) {
  const FittedRotation fit = fitted_rotation(judge.all, R);
  if (judge.doubt(R, fit.R) > kSignificant) return fit;
  return {R, std::hypot(fit.sigma, angle_between(R, fit.R))};
}

}  // namespace

Axes choose_axes(const Judge& judge, std::vector<Axes>* alike) {
  const std::vector<Axes> list = hypotheses(judge);
  const auto explained = [&](const Axes& axes) { return judge.all.explained(axes.R); };
  const auto best = std::ranges::max_element(list, {}, explained);
  const double enough = 0.9 * explained(*best);
  for (const Axes& axes : list) {
    const auto is_same = [&](const Axes& known) { return (known.R - axes.R).norm() < 1e-6; };
    if (std::ranges::any_of(*alike, is_same)) continue;
    if (&axes == &*best ||
        (explained(axes) > enough && judge.doubt(axes.R, best->R) < kSignificant)) {
      alike->push_back(axes);
    }
  }
  const auto prefer = [alike](const auto& is_likelier) {
    const auto found = std::ranges::find_if(*alike, is_likelier);
    if (found != alike->end()) std::iter_swap(alike->begin(), found);
  };
  // of a plane motion an inverted accelerometer is the same as a radar turned by 180 deg
  if (inverts_the_accelerometer(judge, alike->front())) {
    prefer([](const Axes& axes) { return !axes.doppler_flipped; });
  }
  // the same matrix up to a tilt of the mounting; mirrored points are the more likely error
  const bool strange = alike->front().doppler_flipped && alike->front().turn > 1e-6 &&
                       !seems_opposite(judge.data.doppler_sign);
  if (strange) {
    prefer([&](const Axes& axes) { return mirror_of_points(axes, judge.configured).has_value(); });
  }
  // of a plane motion a radar that is upside down is the same as an angle counted the other way
  if (alike->front().turn > 1e-6 && judge.advice.has("azimuth")) {
    prefer([&](const Axes& axes) {
      return judge.advice.mirror(judge.configured.transpose() * axes.R).has_value();
    });
  }
  return alike->front();
}

Finding compensated(const Judge& judge, const std::string& text) {
  constexpr double kWild = 1.0;  // more, in any direction, is no vehicle [m/s^2]
  if (judge.all.movement_of_imu() > kWild * judge.length) {
    return {Verdict::kDoubtful, "axes and Doppler sign",
            text + ", or the IMU too much of it: its rates and its forces do not fit together",
            "look at the unit and the axes of the gyro"};
  }
  return {Verdict::kWrong, "Doppler", text,
          "record the measured Doppler: the driver subtracts the motion of the vehicle from it "
          "(compensated), or fills in zeros"};
}

Finding check_axes(const Judge& judge, const Axes& found, const std::vector<Axes>& alike) {
  const double as_configured = judge.all.explained(judge.configured);
  const double best = judge.all.explained(found.R);
  Finding out{
      Verdict::kOk, "axes and Doppler sign",
      fmt::format("with mounting and Doppler as configured the radar explains {:.0f} % of the "
                  "movement the IMU measures",
                  100.0 * as_configured)};
  const bool unknown = MountingSearch::is_unknown(judge.options.calibration);
  if (unknown) {
    out.text = fmt::format(
        "the mounting is unknown: it is found in flight; without a mirror the radar explains at "
        "most {:.0f} % of the movement the IMU measures",
        100.0 * as_configured);
  }
  if (best < kExplained) {
    say_nothing_explains(judge, best, &out);
    return out;
  }
  if (unknown && !found.doppler_flipped) {
    if (alike.size() == 1) out.text += right_angle_text(found.R);
    return out;
  }
  if (found.as_configured()) {
    out.text += alike.size() == 1
                    ? ", clearly more than with any other axes"
                    : fmt::format("; {} other axes would do as well", alike.size() - 1);
    return out;
  }
  const bool clearly_worse =
      !(as_configured > 0.8 * best) && judge.doubt(judge.configured, found.R) > kSignificant;
  out.verdict = clearly_worse ? Verdict::kWrong : Verdict::kDoubtful;
  if (inverts_the_accelerometer(judge, found)) {
    out.text += fmt::format(", and {:.0f} % with the accelerometer negated", 100.0 * best);
    out.change =
        "--accel-unit -m/s^2 (-UNIT if one is given): the accelerometer has the wrong sign, as at "
        "rest it reads +9.81 m/s^2 on the axis that is up";
    return out;
  }
  if (unknown) {
    out.text += fmt::format(
        ", and {:.0f} % if the Doppler has the wrong sign, or an axis of the "
        "points",
        100.0 * best);
    out.change = judge.advice.negate_doppler() + ", or look at the axes of the points";
    return out;
  }
  const DopplerSign sign = judge.data.doppler_sign;
  for (const Axes& axes : alike) {
    const Matrix3d turn = axes.R * judge.configured.transpose();
    const auto imu_axes = judge.advice.imu_axes(turn, judge.data.imu.check.rest.accel);
    if (!imu_axes) continue;
    out.text += fmt::format(", and {:.0f} % if the IMU is in {}, as its gravity also shows",
                            100.0 * judge.all.explained(axes.R), *imu_axes);
    out.change = "--imu-axes " + *imu_axes;
    if (*imu_axes == "frd") out.change += " (flu, if they are turned from frd already)";
    return out;
  }
  out.text +=
      fmt::format(", and {:.0f} % if {}", 100.0 * best, describe(judge.configured, found, sign));
  for (std::size_t i = 1; i < std::min<std::size_t>(alike.size(), 4); ++i) {
    out.text += ", or as well if " + describe(judge.configured, alike[i], sign);
  }
  out.change = change_of(judge.configured, found, proposed_mounting(judge, found.R), sign,
                         judge.options, judge.advice);
  return out;
}

}  // namespace rio::check
