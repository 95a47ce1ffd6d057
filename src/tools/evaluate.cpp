// SPDX-License-Identifier: BSD-3-Clause
// `rio evaluate`: the error figures of an estimate, as a table or as a JSON line.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "estimator_options.hpp"
#include "evaluate.hpp"
#include "json_line.hpp"
#include "outputs.hpp"
#include "plot/svg.hpp"
#include "recording.hpp"
#include "rio/bag/message_stream.hpp"
#include "rio/bag/recording.hpp"
#include "rio/eval/evaluation.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::tools {

namespace {

using eval::AbsoluteError;
using eval::AngleError;
using eval::Evaluation;
using eval::RelativeError;
using eval::Statistics;

nlohmann::ordered_json to_json(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"max", s.max}, {"std", s.std}};
}

nlohmann::ordered_json to_json(const AbsoluteError& error) {
  return {{"translation_m", to_json(error.translation)}, {"rotation_deg", to_json(error.rotation)}};
}

nlohmann::ordered_json to_json(const RelativeError& error) {
  return {{"distance_m", error.distance},
          {"pieces", error.translation.count},
          {"translation_m", to_json(error.translation)},
          {"translation_percent", to_json(error.drift)},
          {"rotation_deg", to_json(error.rotation)},
          {"rotation_deg_per_m", to_json(error.rotation_per_metre)}};
}

nlohmann::ordered_json to_json(const AngleError& error) {
  return {{"rmse", error.rmse}, {"final", error.final}, {"max", error.max}};
}

constexpr double kOtherAxes = 45.0;  // beyond what an estimate that follows the path is off [deg]

/// What a truth in another unit than metres looks like, to a factor of two; empty if it does not.
std::string unit_of_truth(double size_ratio) {
  for (const auto& [unit, per_metre] : {std::pair("millimetres", 1000.0), {"centimetres", 100.0}}) {
    const bool near = std::abs(std::log(size_ratio / per_metre)) < std::log(2.0);
    if (!near) continue;  // or neither of them moves
    return fmt::format(
        "the true positions span {:.0f} times what the estimate does: they seem to be in {}; "
        "divide "
        "them by {:.0f}",
        size_ratio, unit, per_metre);
  }
  return "";
}

/// `value` in `width` characters, a blank and more if it is longer; "-" if undefined.
std::string cell(double value, int width, int digits) {
  const std::string text = std::isnan(value) ? "-" : plot::fixed(value, digits);
  return width == 0 ? text : fmt::format(" {:>{}}", text, width - 1);
}

std::string rmse_and_median(const Statistics& s, int digits) {
  return cell(s.rmse, 9, digits) + cell(s.median, 9, digits);
}

void print_absolute(const char* name, const AbsoluteError& error) {
  const auto cells = [](const Statistics& s, int digits) {
    return cell(s.rmse, 9, digits) + cell(s.mean, 9, digits) + cell(s.median, 9, digits) +
           cell(s.max, 9, digits) + cell(s.std, 9, digits);
  };
  fmt::print("  {:<14}{}   {}\n", name, cells(error.translation, 3), cells(error.rotation, 2));
}

void print_angle(const char* name, const AngleError& error) {
  fmt::print("  {:<14}{} deg rmse {} deg final {} deg max\n", name, cell(error.rmse, 9, 2),
             cell(error.final, 9, 2), cell(error.max, 9, 2));
}

void print_figures(const EvaluateArguments& arguments, const std::string& estimate,
                   const Evaluation& e) {
  fmt::print(
      "truth     {}\nestimate  {}\n"
      "          {} of {} poses have a true pose ({:.1f} %)\n"
      "          {:.2f} s, true path {:.2f} m\n",
      arguments.truth, estimate, e.associated, e.estimates,
      100.0 * static_cast<double>(e.associated) / static_cast<double>(e.estimates), e.duration,
      e.path_length);

  const char* heads = "     rmse     mean   median      max      std";
  fmt::print("\nAPE             {:<45}   {}\n  alignment     {}   {}\n", "    translation [m]",
             "    rotation [deg]", heads, heads);
  print_absolute("none", e.ape_none);
  print_absolute("yaw+position", e.ape_yaw);
  print_absolute("SE(3)", e.ape_se3);
  if (!e.yaw_unique) fmt::print("  yaw+position: no horizontal motion, yaw left as it is\n");
  if (!e.se3_unique) {
    fmt::print("  SE(3): the path is a line, its alignment leaves the rotation open\n");
  }

  const char* columns = "     rmse   median";
  fmt::print("\nRPE               {:<18}   {:<18}   {}\n  over     pieces {}   {}   {}\n",
             "  translation [%]", "  translation [m]", "  rotation [deg/m]", columns, columns,
             columns);
  for (const RelativeError& r : e.rpe) {
    fmt::print("  {:4.0f} m {:8} {}   {}   {}\n", r.distance, r.translation.count,
               rmse_and_median(r.drift, 2), rmse_and_median(r.translation, 3),
               rmse_and_median(r.rotation_per_metre, 3));
  }

  fmt::print("\nAlignment: {}\n  {:<14}{} m\n", arguments.align, "norm of MAE",
             cell(e.norm_of_mae, 9, 3));
  if (!std::isnan(arguments.mae_at)) {
    fmt::print("  {:<14}{} m up to {:g} m of path\n", "", cell(e.norm_of_mae_at, 9, 3),
               arguments.mae_at);
  }
  fmt::print("  {:<14}{} m\n  {:<14}{} % of the path\n", "norm of RMSE", cell(e.norm_of_rmse, 9, 3),
             "final drift", cell(e.final_drift, 9, 2));
  print_angle("yaw error", e.yaw);
  print_angle("tilt error", e.tilt);
}

}  // namespace

std::string evaluation_json(const EvaluateArguments& arguments, const std::string& estimate,
                            const Evaluation& e) {
  nlohmann::ordered_json json = {
      {"truth", arguments.truth},
      {"estimate", estimate},
      {"align", arguments.align},
      {"poses", e.estimates},
      {"associated", e.associated},
      {"duration_s", e.duration},
      {"path_length_m", e.path_length},
      {"ape",
       {{"none", to_json(e.ape_none)}, {"yaw", to_json(e.ape_yaw)}, {"se3", to_json(e.ape_se3)}}},
      {"rpe", nlohmann::ordered_json::array()},
      {"norm_of_mae_m", e.norm_of_mae},
      {"norm_of_rmse_m", e.norm_of_rmse},
      {"final_drift_percent", e.final_drift},
      {"yaw_error_deg", to_json(e.yaw)},
      {"tilt_error_deg", to_json(e.tilt)}};
  for (const RelativeError& error : e.rpe) json["rpe"].push_back(to_json(error));
  if (!std::isnan(arguments.mae_at)) {
    json["norm_of_mae_at"] = {{"distance_m", arguments.mae_at}, {"value_m", e.norm_of_mae_at}};
  }
  return json_line(json);
}

eval::EvaluationOptions options_of(const EvaluateArguments& arguments) {
  eval::EvaluationOptions options;
  options.alignment = *eval::alignment_kind(arguments.align);
  options.max_difference = from_seconds(arguments.max_diff);
  options.mae_distance = arguments.mae_at;
  return options;
}

Evaluation evaluate_poses(const EvaluateArguments& arguments, const eval::Trajectory& truth,
                          const eval::Trajectory& estimate, const std::string& name) {
  try {
    return eval::evaluate(truth, estimate, options_of(arguments));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(name + " against " + arguments.truth + ": " + error.what());
  }
}

std::vector<std::string> default_labels(const std::vector<std::string>& paths) {
  const auto name = [](const std::string& given) {
    const std::filesystem::path path = named(given);
    return std::pair(path.parent_path().filename().string(), path.stem().string());
  };
  std::vector<std::string> labels;
  for (const std::string& path : paths) {
    const auto same = [&](const std::string& other) {
      return name(other).second == name(path).second;
    };
    const auto [folder, stem] = name(path);
    const bool shared = std::count_if(paths.begin(), paths.end(), same) > 1;
    labels.push_back(stem);
    if (shared && !folder.empty()) labels.back().insert(0, folder + "/");
  }
  const std::vector<std::string> short_names = labels;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (std::size_t k = 0; k < labels.size(); ++k) {
      if (short_names[k] == short_names[i] && paths[k] != paths[i]) labels[i] = paths[i];
    }
  }
  return labels;
}

TextTable comparison_table(const std::vector<NamedEvaluation>& all) {
  TextTable rows = {{"estimate", "final drift [%]", "norm of MAE [m]", "norm of RMSE [m]",
                     "yaw RMSE [deg]", "tilt RMSE [deg]", "RPE over 10 m [%]", "true path [m]"}};
  for (const auto& [name, e] : all) {
    double relative = eval::kNan;
    for (const RelativeError& error : e.rpe) {
      if (error.distance == 10.0) relative = error.drift.rmse;
    }
    rows.push_back({name, cell(e.final_drift, 0, 2), cell(e.norm_of_mae, 0, 3),
                    cell(e.norm_of_rmse, 0, 3), cell(e.yaw.rmse, 0, 2), cell(e.tilt.rmse, 0, 2),
                    cell(relative, 0, 2), cell(e.path_length, 0, 1)});
  }
  return rows;
}

void print_table(const TextTable& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fmt::print("| {} |\n", fmt::join(rows[i], " | "));
    if (i > 0) continue;
    for (std::size_t k = 0; k < rows[i].size(); ++k) fmt::print("|---");
    fmt::print("|\n");
  }
}

eval::Trajectory path_of(const std::string& path, const std::string& topic, io::Attitude attitude) {
  if (io::is_dataset_folder(path) || !bag::begins_as_recording(path)) {
    if (!topic.empty()) throw std::runtime_error(path + ": is no bag, so has no topic " + topic);
    return io::read_trajectory(path, io::TumOrder::kStrict, attitude);
  }
  eval::Trajectory poses;
  for (const NavState& state : bag::read_truth(path, attitude == io::Attitude::kOptional, topic)) {
    poses.push_back({state.time, state.p_WB, state.q_WB});
  }
  return poses;
}

bool has_attitude(const eval::Trajectory& path) {
  return !path.empty() && path.front().q.coeffs().allFinite();
}

void evaluate(const EvaluateArguments& arguments) {
  eval::Trajectory truth = path_of(arguments.truth, arguments.truth_topic, io::Attitude::kOptional);
  if (!truth.empty() && !has_attitude(truth)) {
    print_notes(
        {"the truth holds positions alone, of a prism or an antenna: errors of the attitude and "
         "the RPE, which needs it, are unknown; its place on the vehicle counts as an error"});
  }
  const double offset = stamp_offset(arguments.truth_offset, "--truth-offset");
  for (eval::StampedPose& pose : truth) pose.time += from_seconds(offset);
  std::vector<NamedEvaluation> all;
  const std::vector<std::string> labels = default_labels(arguments.estimates);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::string& file = arguments.estimates[i];
    const eval::Trajectory estimate = path_of(file, arguments.topic);
    expect_common_time({{arguments.truth, truth}, {file, estimate}});
    all.push_back({labels[i], evaluate_poses(arguments, truth, estimate, file)});
    const std::string unit = unit_of_truth(all.back().second.size_ratio);
    if (!unit.empty()) print_notes({unit});
    const double apart = all.back().second.ape_yaw.rotation.median;
    if (apart > kOtherAxes && all.back().second.yaw_unique) {
      print_notes({fmt::format(
          "half of the attitudes of {} are {:.0f} deg or more from the true ones, with the "
          "positions aligned: it is lost, or has other axes of body or world, or another order of "
          "the quaternion; rotations and RPE count that",
          file, apart)});
    }
    const eval::StampOffset best = eval::best_stamp_offset(truth, estimate, options_of(arguments));
    if (!best.is_needed()) continue;
    print_notes(
        {fmt::format("the clocks of truth and {} seem to differ: with --truth-offset \"{:.3f} s\" "
                     "the RMSE of the "
                     "position (yaw aligned) is {:.3f} m instead of {:.3f}",
                     file, offset + to_seconds(best.offset), best.rmse, best.rmse_without)});
  }
  if (all.size() > 1 && !arguments.json) {
    TextTable rows = comparison_table(all);
    for (std::size_t i = 0; i < rows.size() && !std::isnan(arguments.mae_at); ++i) {
      rows[i].push_back(i == 0 ? fmt::format("norm of MAE up to {:g} m [m]", arguments.mae_at)
                               : cell(all[i - 1].second.norm_of_mae_at, 0, 3));
    }
    return print_table(rows);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& file = arguments.estimates[i];
    if (arguments.json) {
      fmt::print("{}\n", evaluation_json(arguments, file, all[i].second));
    } else {
      print_figures(arguments, file, all[i].second);
    }
  }
}

}  // namespace rio::tools
