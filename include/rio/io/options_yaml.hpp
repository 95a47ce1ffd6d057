// SPDX-License-Identifier: BSD-3-Clause
// Option files: YAML nested by stage, keys of rio/option_fields.hpp, SI numbers or "2 deg", "5 cm".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rio/options.hpp"

namespace rio::io {

/// Applies the top-level `preset` key of the text of an option file, if it has one, then all its
/// values. Unknown and duplicate keys, wrong types, units and ranges throw std::runtime_error
/// "NAME:LINE: ..."; an incoherent set throws "NAME: ...". Nothing in `options` changes then.
/// @param name of the file, for messages
void parse_options(const std::string& yaml, const std::string& name, Options* options);

/// The same from several texts without their presets, for callers that insert other values between
/// preset and file. A later text overrides an earlier one; ranges are checked key by key, coherence
/// once, at the end.
void parse_option_values(const std::vector<std::string>& yaml, const std::string& name,
                         Options* options);

/// The `preset` key of the last text that has one.
std::optional<std::string> preset_in_texts(const std::vector<std::string>& yaml,
                                           const std::string& name);

/// The same of the last setting "preset=NAME".
std::optional<std::string> preset_in_settings(const std::vector<std::string>& settings);

/// Applies settings "KEY=VALUE" with the keys and values of option files, in their order; throws as
/// parse_option_values() does, with the setting in place of the file.
void apply_settings(const std::vector<std::string>& settings, Options* options);

/// `base` as the preset changes it.
/// @throws std::runtime_error that tells the presets if there is no such one
Options preset_named(const std::string& name, Options base = {});

/// The preset that has the options which no file sets (Layer::kAlgorithm of visit_preset_fields())
/// as they are; of several the one nearest in the others. Empty if there is none.
std::string preset_of(const Options& options);

/// Every option with its unit and meaning as a comment, and the preset if it is not `default`;
/// reads back to the same options, unless preset_of() them is empty.
std::string options_as_yaml(const Options& options);

/// The same as a template: it names the preset; options of sensor files and of the preset
/// (Layer::kAlgorithm) are commented out, since an option file overrides both.
/// @throws std::runtime_error if there is no such preset
std::string option_file(const std::string& preset_name);

/// "KEY = VALUE (BEFORE)" for each of the keys whose values differ.
std::vector<std::string> changed_options(const Options& before, const Options& after,
                                         const std::vector<std::string>& keys);

/// A Markdown table of the options that differ between presets: a row per option, a column per
/// preset.
std::string presets_as_table();

}  // namespace rio::io
