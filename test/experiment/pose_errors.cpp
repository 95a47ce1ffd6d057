// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/pose_errors.hpp"

#include <fmt/format.h>

#include <cmath>

#include "experiment/spread.hpp"
#include "rio/core/so3.hpp"
#include "rio/eval/metrics.hpp"

namespace rio::experiment {

PoseErrors pose_errors(const std::vector<eval::PosePair>& pairs) {
  const auto step = [](const eval::StampedPose& from, const eval::StampedPose& to) {
    const Quaternion back = from.q.conjugate();
    return eval::StampedPose{to.time, back * (to.p - from.p), back * to.q};
  };
  std::vector<eval::PosePair> steps;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    steps.push_back(
        {step(pairs[i - 1].truth, pairs[i].truth), step(pairs[i - 1].estimate, pairs[i].estimate)});
  }
  // an absolute error of steps is (E2): the rotation of the true step does not change its norms
  const eval::AbsoluteError absolute = eval::absolute_error(pairs);
  const eval::AbsoluteError relative = eval::absolute_error(steps);
  return {absolute.translation.rmse, absolute.rotation.rmse, relative.translation.rmse,
          relative.rotation.rmse};
}

std::vector<double> PoseErrorTable::values(const Key& key, double PoseErrors::*value) const {
  std::vector<double> list;
  for (const auto& [seed, errors] : runs_.at(key)) list.push_back(errors.*value);
  return list;
}

std::string PoseErrorTable::change(const Key& key, const std::string& reference,
                                   const PoseErrorFigure& figure) const {
  const std::map<std::uint64_t, PoseErrors>& others = runs_.at({key.group, reference});
  std::vector<double> differences;
  for (const auto& [seed, errors] : runs_.at(key)) {
    differences.push_back(errors.*figure.value - others.at(seed).*figure.value);
  }
  return mean_with_error(differences, figure.decimals);
}

std::string PoseErrorTable::as_csv() const {
  std::string text = "group,variant,seed,ape [m],ape [deg],rpe [m],rpe [deg]\n";
  for (const auto& [key, by_seed] : runs_) {
    for (const auto& [seed, e] : by_seed) {
      text += fmt::format("{},\"{}\",{},{:.6g},{:.6g},{:.6g},{:.6g}\n", key.group, key.variant,
                          seed, e.ape, e.ape_angle, e.rpe, e.rpe_angle);
    }
  }
  return text;
}

}  // namespace rio::experiment
