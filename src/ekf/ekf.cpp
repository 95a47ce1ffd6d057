// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/ekf.hpp"

namespace rio {

Ekf::Ekf(const Options& options)
    : options_(options),
      // without trails nothing is measured from a past pose
      belief_(options, options.update.use_trails ? options.update.max_clones : 0),
      rows_(options),
      compression_(rows_.capacity()),
      panels_(belief_.layout().capacity()),
      reexpression_(belief_.layout().capacity()),
      dx_(Eigen::VectorXd::Zero(belief_.layout().capacity())) {}

void Ekf::reset(const NavState& prior, const BodyCovariance& P0) {
  belief_.reset(prior, P0);
  rows_.reset();
}

void Ekf::drop_landmarks(UpdateReport* report) {
  for (std::size_t i = estimate().landmarks.size(); i-- > 0;) {
    belief_.remove_landmark(i);
    ++report->landmarks_removed;
  }
}

void Ekf::restart_velocity(const Vector3d& v_B, const Matrix3d& covariance_B, double duration,
                           double doubtful, UpdateReport* report) {
  drop_landmarks(report);
  belief_.restart_velocity(v_B, covariance_B, duration, doubtful);
}

Status Ekf::update(const Observations& seen, UpdateReport* report) {
  const RowBatch& rows = rows_.build(seen, belief_, report);
  if (!panels_.apply(compression_.compress(rows), &belief_.covariance(), &dx_))
    return Status::kNumerical;
  before_ = belief_.estimate();
  belief_.correct(dx_);
  if (options_.update.consistent_covariance) {
    reexpression_.apply(belief_.layout(), before_, belief_.estimate(), &belief_.covariance());
  }
  for (const Contradiction& c : belief_.contradictions()) {
    belief_.covariance().forget(c.column, c.value, c.information, &dx_);
    belief_.correct(dx_);
  }
  return Status::kOk;
}

void Ekf::maintain_landmarks(const Observations& seen, const Promotions& promotions,
                             UpdateReport* report) {
  rio::maintain_landmarks(
      seen, rows_, promotions, options_, &belief_.estimate(), report,
      [this](std::size_t i) { belief_.remove_landmark(i); },
      [this](const Detection& d) { belief_.add_landmark(d); });
}

}  // namespace rio
