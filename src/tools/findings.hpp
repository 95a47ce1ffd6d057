// SPDX-License-Identifier: BSD-3-Clause
// What of a recording is checked; the findings of `rio check` and their output.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "check/check.hpp"
#include "check/clock_steps.hpp"
#include "check/finding.hpp"
#include "commands.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/recording_stream.hpp"
#include "rio/io/scan_folder.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// The edits are those of the folder that `rio convert` makes of a folder with a file a scan.
check::Findings edits_of_converted(check::Findings findings);

/// Checks a recording or a part of it.
/// @param data result of read_any() for `path`, or check::CheckedData
template <class Data>
check::Findings findings_of(const std::string& path, const Data& data, const Options& options) {
  if (io::is_asl_folder(path)) {
    return check::check_recording(data, options, check::Source::kFolder, io::dataset_root(path));
  }
  if (!io::is_scan_folder(path)) {
    return check::check_recording(data, options, check::Source::kBag);
  }
  return edits_of_converted(check::check_recording(data, options, check::Source::kFolder));
}

/// `rio check` without its output.
struct Checked {
  check::Findings findings;
  std::vector<std::string> notes;  ///< of the recording and of the options
  std::string damage;              ///< empty, or where the recording is damaged: it ends there
};
Checked run_check(const CheckArguments& arguments);

/// One object per finding.
nlohmann::ordered_json findings_json(const check::Findings& findings);

/// The options at the beginning of the proposed changes, as lines of an option file, one for each
/// section. "radar: {a: 1}" and "radar: {b: 2}, or ..." give "radar: {a: 1, b: 2}".
std::string proposed_options(const check::Findings& findings);

/// Removes what is said of a start from rest: the estimator starts in another way.
void without_start(check::Findings* findings);

/// The doubtful and the wrong ones.
check::Findings not_ok(check::Findings findings);

/// One line each, "data: nothing found" if there are none.
std::string findings_text(const check::Findings& findings);

/// The wrong ones on the standard error: what follows from such data is wrong as well.
void print_wrong(check::Findings findings);

/// Why a replay has not started, with what `check` found as the causes.
std::string no_start_text(const std::optional<check::Findings>& data);

/// The beginning of a recording, for `rio check`: all of one of ten minutes.
struct CheckedPart {
  check::CheckedData data;
  std::optional<double> seconds;  ///< its length; empty: it is all
};
/// @param sensors their properties
CheckedPart read_checked_part(io::RecordingStream* stream, const io::Dataset& sensors);

/// Of each sensor, as the checked part of the recording shows them. It is read only if some stamps
/// look like steps.
/// @param options with the sensor properties of the recording
/// @param notes one more for every step
check::ClockSteps find_clock_steps(io::RecordingStream* stream, const io::Dataset& sensors,
                                   const Options& options, std::vector<std::string>* notes);

/// Takes the steps of all clocks out of a recording, with a note for each.
/// @param options with the sensor properties of the recording
void take_out_clock_steps(const Options& options, io::Dataset* dataset);

}  // namespace rio::tools
