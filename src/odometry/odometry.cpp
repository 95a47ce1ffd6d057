// SPDX-License-Identifier: BSD-3-Clause
// The odometry API.
#include "rio/rio.hpp"

#include <algorithm>
#include <utility>

#include "odometry_impl.hpp"

namespace rio {

std::unique_ptr<Odometry> Odometry::create(const Options& options, std::string* why) {
  if (!options.validate(why)) return nullptr;
  if (options.backend == BackEnd::kEkf) {
    return std::unique_ptr<Odometry>(new Odometry(make_ekf_engine(options)));
  }
#ifdef RIO_WITHOUT_SMOOTHER
  if (why != nullptr) *why = "backend: this library was built without the smoother";
  return nullptr;
#else
  return std::unique_ptr<Odometry>(new Odometry(make_smoother_engine(options)));
#endif
}

Odometry::Odometry(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Odometry::~Odometry() = default;

Status Odometry::add_imu(const ImuSample& sample) noexcept {
  return impl_->add_imu(sample);
}
Status Odometry::add_scan(const RadarScan& scan, std::size_t radar) noexcept {
  return impl_->add_scan(scan, radar);
}
Status Odometry::add_measurement(const AidingMeasurement& measurement) noexcept {
  return impl_->add_measurement(measurement);
}
bool Odometry::auxiliary(const char* name, double* value, double* covariance, int index,
                         int size) const noexcept {
  return impl_->auxiliary(name, index, size, value, covariance);
}
Status Odometry::reset(const NavState& prior, const BodyCovariance& P0) noexcept {
  return impl_->reset(prior, P0);
}
void Odometry::reset() noexcept {
  impl_->reset();
}

bool Odometry::initialized() const noexcept {
  return impl_->initialized;
}
const NavState& Odometry::now() const noexcept {
  return impl_->now();
}
const NavState& Odometry::at_scan() const noexcept {
  return impl_->at_scan();
}
const BodyCovariance& Odometry::covariance() const noexcept {
  return impl_->covariance;
}
const BodyCovariance& Odometry::covariance_now() const noexcept {
  return impl_->covariance_now();
}
const Health& Odometry::health() const noexcept {
  return impl_->health();
}
std::size_t Odometry::radars() const noexcept {
  return impl_->extrinsics.size();
}
const Pose& Odometry::extrinsics(std::size_t radar) const noexcept {
  return impl_->extrinsics[std::min(radar, impl_->extrinsics.size() - 1)];
}
const UpdateReport& Odometry::report() const noexcept {
  return impl_->report();
}
const std::vector<PointReport>& Odometry::points() const noexcept {
  return impl_->points();
}
const std::vector<LandmarkReport>& Odometry::landmarks() const noexcept {
  return impl_->landmarks();
}
const Counters& Odometry::counters() const noexcept {
  return impl_->counters;
}
void Odometry::on_scan(std::function<void()> call) noexcept {
  impl_->on_scan = std::move(call);
  impl_->on_scan_set = true;
}

}  // namespace rio
