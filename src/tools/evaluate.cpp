// SPDX-License-Identifier: BSD-3-Clause
// `rio evaluate`: the error figures of an estimate, as a table or as a JSON line.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands.hpp"
#include "comparison.hpp"
#include "evaluate.hpp"
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

/// Undefined figures (NaN) become null.
nlohmann::ordered_json to_json(const EvaluateArguments& arguments, const std::string& estimate,
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
  return json;
}

}  // namespace

std::string evaluation_json(const EvaluateArguments& arguments, const std::string& estimate,
                            const Evaluation& e) {
  return to_json(arguments, estimate, e).dump();
}

namespace {

/// `value` in `width` characters, "-" if undefined.
std::string cell(double value, int width, int digits) {
  char text[64];
  if (std::isnan(value)) {
    std::snprintf(text, sizeof text, "%*s", width, "-");
  } else {
    std::snprintf(text, sizeof text, "%*.*f", width, digits, value);
  }
  return text;
}

std::string cells(const Statistics& s, int digits) {
  return cell(s.rmse, 9, digits) + cell(s.mean, 9, digits) + cell(s.median, 9, digits) +
         cell(s.max, 9, digits) + cell(s.std, 9, digits);
}

void print_absolute(const char* name, const AbsoluteError& error) {
  std::printf("  %-14s%s   %s\n", name, cells(error.translation, 3).c_str(),
              cells(error.rotation, 2).c_str());
}

void print_relative(const RelativeError& e) {
  std::printf("  %4.0f m %8zu %s%s   %s%s   %s%s\n", e.distance, e.translation.count,
              cell(e.drift.rmse, 9, 2).c_str(), cell(e.drift.median, 9, 2).c_str(),
              cell(e.translation.rmse, 9, 3).c_str(), cell(e.translation.median, 9, 3).c_str(),
              cell(e.rotation_per_metre.rmse, 9, 3).c_str(),
              cell(e.rotation_per_metre.median, 9, 3).c_str());
}

void print_angle(const char* name, const AngleError& error) {
  std::printf("  %-14s%s deg rmse %s deg final %s deg max\n", name, cell(error.rmse, 9, 2).c_str(),
              cell(error.final, 9, 2).c_str(), cell(error.max, 9, 2).c_str());
}

void print_table(const EvaluateArguments& arguments, const std::string& estimate,
                 const Evaluation& e) {
  std::printf("truth     %s\nestimate  %s\n", arguments.truth.c_str(), estimate.c_str());
  std::printf("          %zu of %zu poses have a true pose (%.1f %%)\n", e.associated, e.estimates,
              100.0 * static_cast<double>(e.associated) / static_cast<double>(e.estimates));
  std::printf("          %.2f s, true path %.2f m\n", e.duration, e.path_length);

  const char* heads = "     rmse     mean   median      max      std";
  std::printf("\nAPE             %-45s   %s\n  alignment     %s   %s\n", "    translation [m]",
              "    rotation [deg]", heads, heads);
  print_absolute("none", e.ape_none);
  print_absolute("yaw+position", e.ape_yaw);
  print_absolute("SE(3)", e.ape_se3);
  if (!e.yaw_unique) std::printf("  yaw+position: no horizontal motion, yaw left as it is\n");
  if (!e.se3_unique) {
    std::printf("  SE(3): the path is a line, its alignment leaves the rotation open\n");
  }

  const char* relative_heads = "     rmse   median";
  std::printf("\nRPE               %-18s   %-18s   %s\n  over     pieces %s   %s   %s\n",
              "  translation [%]", "  translation [m]", "  rotation [deg/m]", relative_heads,
              relative_heads, relative_heads);
  for (const RelativeError& error : e.rpe) print_relative(error);

  std::printf("\nAlignment: %s\n", arguments.align.c_str());
  std::printf("  %-14s%s m\n", "norm of MAE", cell(e.norm_of_mae, 9, 3).c_str());
  if (!std::isnan(arguments.mae_at)) {
    std::printf("  %-14s%s m up to %g m of path\n", "", cell(e.norm_of_mae_at, 9, 3).c_str(),
                arguments.mae_at);
  }
  std::printf("  %-14s%s m\n", "norm of RMSE", cell(e.norm_of_rmse, 9, 3).c_str());
  std::printf("  %-14s%s %% of the path\n", "final drift", cell(e.final_drift, 9, 2).c_str());
  print_angle("yaw error", e.yaw);
  print_angle("tilt error", e.tilt);
}

}  // namespace

Evaluation evaluate_poses(const EvaluateArguments& arguments, const eval::Trajectory& truth,
                          const eval::Trajectory& estimate, const std::string& name) {
  eval::EvaluationOptions options;
  options.alignment = *eval::alignment_kind(arguments.align);
  options.max_difference = from_seconds(arguments.max_diff);
  options.mae_distance = arguments.mae_at;
  try {
    return eval::evaluate(truth, estimate, options);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(name + " against " + arguments.truth + ": " + error.what());
  }
}

TextTable comparison_table(const std::vector<std::string>& names,
                           const std::vector<Evaluation>& all) {
  TextTable rows = {{"estimate", "final drift [%]", "norm of MAE [m]", "norm of RMSE [m]",
                     "yaw RMSE [deg]", "tilt RMSE [deg]", "RPE over 10 m [%]"}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Evaluation& e = all[i];
    double relative = eval::kNan;
    for (const RelativeError& error : e.rpe) {
      if (error.distance == 10.0) relative = error.drift.rmse;
    }
    rows.push_back({names[i], cell(e.final_drift, 0, 2), cell(e.norm_of_mae, 0, 3),
                    cell(e.norm_of_rmse, 0, 3), cell(e.yaw.rmse, 0, 2), cell(e.tilt.rmse, 0, 2),
                    cell(relative, 0, 2)});
  }
  return rows;
}

void print_table(const TextTable& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::string line = "|";
    std::string rule = "|";
    for (const std::string& text : rows[i]) {
      line += " " + text + " |";
      rule += "---|";
    }
    std::printf("%s\n", line.c_str());
    if (i == 0) std::printf("%s\n", rule.c_str());
  }
}

eval::Trajectory truth_of(const std::string& path) {
  if (io::is_dataset_folder(path) || !bag::begins_as_recording(path))
    return io::read_trajectory(path);
  eval::Trajectory truth;
  for (const NavState& state : bag::read_truth(path)) {
    truth.push_back({state.time, state.p_WB, state.q_WB});
  }
  return truth;
}

void evaluate(const EvaluateArguments& arguments) {
  const eval::Trajectory truth = truth_of(arguments.truth);
  std::vector<Evaluation> all;
  for (const std::string& file : arguments.estimates) {
    all.push_back(evaluate_poses(arguments, truth, io::read_trajectory(file), file));
  }
  if (arguments.json) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      std::printf("%s\n", evaluation_json(arguments, arguments.estimates[i], all[i]).c_str());
    }
  } else if (all.size() == 1) {
    print_table(arguments, arguments.estimates[0], all[0]);
  } else {
    std::vector<std::string> names;
    for (const std::string& file : arguments.estimates) {
      names.push_back(std::filesystem::path(file).stem().string());
    }
    print_table(comparison_table(names, all));
  }
}

}  // namespace rio::tools
