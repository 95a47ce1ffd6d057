// SPDX-License-Identifier: BSD-3-Clause
#include "compare_page.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "evaluate.hpp"
#include "rio/eval/metrics.hpp"

namespace rio::tools {

namespace {

/// Those of the truth, or of a run, at the times of another.
using PosesByTime = std::map<Time, eval::StampedPose>;
PosesByTime poses_of(const std::vector<eval::PosePair>& pairs) {
  PosesByTime poses;
  for (const eval::PosePair& pair : pairs) poses.emplace(pair.estimate.time, pair.truth);
  return poses;
}

/// The run that lasts longest.
const eval::Trajectory& longest_of(const std::vector<Run>& runs) {
  const auto span = [](const Run& run) { return run.poses.back().time - run.poses.front().time; };
  return std::max_element(runs.begin(), runs.end(),
                          [&span](const Run& a, const Run& b) { return span(a) < span(b); })
      ->poses;
}

}  // namespace

view::Page page_of(const std::vector<Run>& runs, const eval::Trajectory& truth) {
  view::Page page;
  const eval::Trajectory& times = longest_of(runs);
  page.begin = times.front().time;
  const PosesByTime true_poses = poses_of(eval::associate(truth, times).pairs);
  const bool attitude = has_attitude(truth);
  std::vector<PosesByTime> there;  // of each run at those times
  const auto add = [&page](const eval::StampedPose& pose) {
    page.paths.back().add(to_seconds(pose.time - page.begin), pose.p, pose.q);
  };
  for (const Run& run : runs) {
    page.paths.push_back({run.name});
    for (const eval::StampedPose& pose : run.poses) add(pose);
    there.push_back(poses_of(eval::associate_interpolated(run.poses, times, kGap).pairs));
  }
  if (!truth.empty()) page.paths.push_back({"truth"});
  for (const auto& [time, pose] : true_poses) {
    page.paths.back().add(to_seconds(time - page.begin), pose.p);
  }

  for (const auto& [time, p, q] : times) {
    page.columns.start_row(to_seconds(time - page.begin));
    const auto known = true_poses.find(time);
    const auto first = there.front().find(time);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const auto found = there[i].find(time);
      if (found == there[i].end()) continue;
      const eval::StampedPose& other = found->second;
      const std::string k = std::to_string(i);
      page.columns.set("z" + k, other.p.z());
      if (i > 0 && first != there.front().end()) {
        page.columns.set("d" + k, (other.p - first->second.p).norm());
        page.columns.set("y" + k, eval::yaw_error({first->second, other}));
      }
      if (known == true_poses.end()) continue;
      const eval::PosePair pair{known->second, other};
      page.columns.set("e" + k, (other.p - pair.truth.p).norm());
      if (!attitude) continue;
      page.columns.set("a" + k, eval::yaw_error(pair));
      page.columns.set("t" + k, eval::tilt_error(pair));
    }
  }
  const auto plot = [&](const std::string& title, const std::string& note, const char* column) {
    view::Plot out{"Over time", title, note, {}};
    for (std::size_t i = 0; i < runs.size(); ++i) {
      out.curves.push_back({runs[i].name, column + std::to_string(i)});
    }
    page.plots.push_back(std::move(out));
  };
  const std::string to_first = "from " + runs.front().name;
  plot("Position error [m]", "distance from the truth", "e");
  plot("Yaw error [deg]", "against the truth", "a");
  plot("Tilt error [deg]", "against the truth", "t");
  plot("Difference of position [m]", to_first, "d");
  plot("Difference of yaw [deg]", to_first, "y");
  plot("Height [m]", "", "z");
  return page;
}

}  // namespace rio::tools
