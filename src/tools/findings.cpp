// SPDX-License-Identifier: BSD-3-Clause
#include "findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "check/check.hpp"
#include "recording.hpp"

namespace rio::tools {

namespace {

template <class Data>
check::Findings findings(const std::string& path, const Data& data, const Options& options) {
  if (!io::is_asl_folder(path)) return check::check_recording(data, options, check::Source::kBag);
  return check::check_recording(data, options, check::Source::kFolder, io::dataset_root(path));
}

}  // namespace

check::Findings findings_of(const std::string& path, const io::Dataset& dataset,
                            const Options& options) {
  return findings(path, dataset, options);
}

check::Findings findings_of(const std::string& path, const check::CheckedData& data,
                            const Options& options) {
  return findings(path, data, options);
}

nlohmann::ordered_json findings_json(const check::Findings& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const check::Finding& f : findings) {
    list.push_back({{"verdict", to_string(f.verdict)},
                    {"subject", f.subject},
                    {"text", f.text},
                    {"change", f.change}});
  }
  return list;
}

std::string proposed_options(const check::Findings& findings) {
  std::string lines;
  for (const std::string_view head : {"radar: {", "start: {"}) {
    std::string all;
    for (const check::Finding& f : not_ok(findings)) {
      if (f.change.rfind(head, 0) != 0) continue;
      int depth = 1;
      std::size_t end = head.size();
      for (; end < f.change.size() && depth > 0; ++end) {
        depth += f.change[end] == '{' ? 1 : f.change[end] == '}' ? -1 : 0;
      }
      all += (all.empty() ? "" : ", ") + f.change.substr(head.size(), end - 1 - head.size());
    }
    if (!all.empty()) lines += (lines.empty() ? "" : "\n") + std::string(head) + all + "}";
  }
  return lines;
}

void without_start(check::Findings* findings) {
  std::erase_if(*findings, [](const check::Finding& f) { return f.subject == "start"; });
}

check::Findings not_ok(const check::Findings& findings) {
  check::Findings out;
  std::copy_if(findings.begin(), findings.end(), std::back_inserter(out),
               [](const check::Finding& f) { return f.verdict != check::Verdict::kOk; });
  return out;
}

std::string findings_text(const check::Findings& findings) {
  std::string text;
  for (const check::Finding& f : findings) {
    text +=
        fmt::format("data {}: {}: {} -> {}\n", to_string(f.verdict), f.subject, f.text, f.change);
  }
  return text.empty() ? "data: nothing found\n" : text;
}

}  // namespace rio::tools
