// SPDX-License-Identifier: BSD-3-Clause
// The findings of `rio check` for the commands that print them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "check/check.hpp"
#include "check/finding.hpp"
#include "commands.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// Checks what read_any() gave for `path`, or a part of it.
check::Findings findings_of(const std::string& path, const io::Dataset& dataset,
                            const Options& options);

check::Findings findings_of(const std::string& path, const check::CheckedData& data,
                            const Options& options);

/// One object a finding.
nlohmann::ordered_json findings_json(const check::Findings& findings);

/// The options that the findings begin their changes with, as one line of an option file; empty
/// without any. "radar: {a: 1}" and "radar: {b: 2}, or ..." make "radar: {a: 1, b: 2}".
std::string proposed_options(const check::Findings& findings);

/// Those that are doubtful or wrong.
check::Findings not_ok(const check::Findings& findings);

/// One line each, "data: nothing found" without any.
std::string findings_text(const check::Findings& findings);

}  // namespace rio::tools
