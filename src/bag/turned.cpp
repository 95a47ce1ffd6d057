// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/turned.hpp"

#include <utility>

namespace rio::bag {

namespace {

class Turned final : public io::RecordingStream {
 public:
  Turned(std::unique_ptr<io::RecordingStream> folder, const RecordingRequest& request)
      : folder_(std::move(folder)),
        imu_(flu_from(request.imu_axes.value_or(Axes::kFlu))),
        gyro_unit_(request.gyro_unit),
        accel_unit_(request.accel_unit),
        doppler_sign_(request.points.approaching ? -1.0 : 1.0) {
    outline_ = folder_->outline();
    add(request.points.axes, &outline_.sensors.radar_info);
    for (io::Dataset::OtherRadar& other : outline_.sensors.other_radars) {
      add(request.points.axes, &other.info);
    }
  }

 private:
  /// The next radar; its format has turned its points from the axes of its files already.
  void add(const std::string& axes, io::RadarInfo* info) {
    const auto named = [](const std::string& name) {
      return flu_from(name.empty() ? Axes::kFlu : axes_named(name));
    };
    points_.push_back(axes.empty() ? Matrix3d(Matrix3d::Identity())
                                   : Matrix3d(named(axes) * named(info->axes).transpose()));
    if (!axes.empty()) info->axes = axes;
  }

  bool read(ImuSample* sample) override {
    if (!folder_->next(sample)) return false;
    sample->gyro_B = gyro_unit_ * (imu_ * sample->gyro_B);
    sample->accel_B = accel_unit_ * (imu_ * sample->accel_B);
    return true;
  }
  bool read(RadarScan* scan, std::size_t radar) override {
    if (!folder_->next(scan, radar)) return false;
    for (RadarDetection& d : scan->detections) {
      d.point_S = points_[radar] * d.point_S;
      d.range_rate *= doppler_sign_;
    }
    return true;
  }
  bool read(io::BaroSample* sample) override { return folder_->next(sample); }
  void start_over() override { folder_->rewind(); }

  std::unique_ptr<io::RecordingStream> folder_;
  Matrix3d imu_;
  double gyro_unit_;
  double accel_unit_;
  double doppler_sign_;
  std::vector<Matrix3d> points_;  ///< by radar
};

}  // namespace

std::unique_ptr<io::RecordingStream> turned(std::unique_ptr<io::RecordingStream> folder,
                                            const RecordingRequest& request) {
  return std::make_unique<Turned>(std::move(folder), request);
}

}  // namespace rio::bag
