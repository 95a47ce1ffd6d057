// SPDX-License-Identifier: BSD-3-Clause
// rio.check, rio.evaluate and rio.simulate: the commands of the program, without its output.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "bindings.hpp"
#include "evaluate.hpp"
#include "findings.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::python {

namespace {

using Times = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::dict check(const std::string& path, const std::vector<std::string>& texts,
               const std::string& map, const std::string& sensors) {
  tools::CheckArguments arguments;
  arguments.dataset = path;
  arguments.values.texts = texts;
  arguments.how.map = map;
  arguments.how.sensors = sensors;
  tools::Checked checked;
  {
    const py::gil_scoped_release release;
    checked = tools::run_check(arguments);
  }
  py::list findings;
  for (const check::Finding& f : checked.findings) {
    findings.append(py::make_tuple(to_string(f.verdict), f.subject, f.text, f.change));
  }
  using namespace py::literals;
  return py::dict("findings"_a = findings, "options"_a = tools::proposed_options(checked.findings),
                  "notes"_a = checked.notes, "damage"_a = checked.damage);
}

/// A rio.Path.
using PathArrays = std::tuple<Times, Values, Values>;

eval::Trajectory trajectory_of(const PathArrays& arrays) {
  const auto& [times, positions, orientations] = arrays;
  const py::ssize_t count = times.size();
  if (times.ndim() != 1 || positions.ndim() != 2 || positions.shape(0) != count ||
      positions.shape(1) != 3 || orientations.ndim() != 2 || orientations.shape(0) != count ||
      orientations.shape(1) != 4) {
    throw py::value_error("a path is times (N), positions (N x 3), orientations (N x 4)");
  }
  const auto t = times.unchecked<1>();
  const auto p = positions.unchecked<2>();
  const auto q = orientations.unchecked<2>();
  eval::Trajectory path;
  for (py::ssize_t i = 0; i < count; ++i) {
    path.push_back(
        {Time(t(i)), {p(i, 0), p(i, 1), p(i, 2)}, Quaternion(q(i, 0), q(i, 1), q(i, 2), q(i, 3))});
    const eval::StampedPose& pose = path.back();
    const bool none = pose.q.coeffs().array().isNaN().all();  // positions alone
    const bool turned = none || (pose.q.coeffs().allFinite() && pose.q.norm() > 0.0);
    if (!pose.p.allFinite() || !turned) {
      throw py::value_error("a path: pose " + std::to_string(i) +
                            " is not finite, or has no rotation");
    }
  }
  return path;
}

PathArrays read_path(const std::string& file, bool truth) {
  eval::Trajectory path;
  {
    const py::gil_scoped_release release;
    path = tools::path_of(file, {}, truth ? io::Attitude::kOptional : io::Attitude::kRequired);
  }
  std::vector<std::int64_t> times;
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<double, 4>> orientations;
  for (const eval::StampedPose& pose : path) {
    times.push_back(pose.time.count());
    positions.push_back(xyz(pose.p));
    orientations.push_back(wxyz(pose.q));
  }
  return {as_rows(std::move(times)), as_table(std::move(positions)),
          as_table(std::move(orientations))};
}

std::string evaluate(const PathArrays& true_path, const std::string& truth_name,
                     const PathArrays& path, const std::string& estimate_name,
                     const std::string& align, double max_diff) {
  const eval::Trajectory truth = trajectory_of(true_path);
  const eval::Trajectory estimate = trajectory_of(path);
  if (!eval::alignment_kind(align)) {
    throw py::value_error("align: none, origin, yaw or se3 is expected, not " + align);
  }
  const auto is_turned = [](const eval::StampedPose& pose) { return pose.q.coeffs().allFinite(); };
  if (!std::all_of(estimate.begin(), estimate.end(), is_turned)) {
    throw py::value_error("estimate: a pose has no rotation; only a truth may do without");
  }
  if (!(max_diff >= 0.0)) throw py::value_error("max_diff: seconds, not negative, are expected");
  tools::EvaluateArguments arguments;
  arguments.truth = truth_name;
  arguments.align = align;
  arguments.max_diff = max_diff;
  const py::gil_scoped_release release;
  return tools::evaluation_json(arguments, estimate_name,
                                tools::evaluate_poses(arguments, truth, estimate, estimate_name));
}

void simulate(const std::string& out, const std::string& scenario,
              std::optional<std::uint64_t> seed, std::optional<double> length,
              const std::string& trajectory, std::size_t radars, bool ideal) {
  // the ranges of the program
  if (length && !(*length >= 20.0 && *length <= 1000.0)) {
    throw py::value_error("length: 20 to 1000 m are expected");
  }
  if (radars < 1 || radars > 4) throw py::value_error("radars: 1 to 4 are expected");
  tools::SimulateArguments arguments;
  arguments.out = out;
  arguments.scenario = scenario;
  arguments.seed = seed;
  arguments.length = length;
  arguments.trajectory = trajectory;
  arguments.radars = radars;
  arguments.ideal = ideal;
  tools::run_simulate(arguments);
}

}  // namespace

void bind_commands(py::module_& module) {
  module.def("check", &check, py::arg("path"), py::arg("texts"), py::arg("map"),
             py::arg("sensors"));
  module.def("read_path", &read_path, py::arg("file"), py::arg("truth"));
  module.def("evaluate", &evaluate, py::arg("truth"), py::arg("truth_name"), py::arg("estimate"),
             py::arg("estimate_name"), py::arg("align"), py::arg("max_diff"));
  module.def("simulate", &simulate, py::arg("out"), py::arg("scenario"), py::arg("seed"),
             py::arg("length"), py::arg("trajectory"), py::arg("radars"), py::arg("ideal"),
             py::call_guard<py::gil_scoped_release>());
}

}  // namespace rio::python
