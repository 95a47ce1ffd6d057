// SPDX-License-Identifier: BSD-3-Clause
// A finding of `rio check`: a sentence with numbers, a verdict, and the proposed change.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace rio::check {

enum class Verdict {
  kOk,
  kDoubtful,  ///< to be inspected; an estimate may still be good
  kWrong,     ///< estimates of this recording are not trustworthy until it is changed
};

inline const char* to_string(Verdict verdict) {
  constexpr const char* kNames[] = {"ok", "doubtful", "wrong"};
  return kNames[static_cast<std::size_t>(verdict)];
}

struct Finding {
  Verdict verdict = Verdict::kOk;
  std::string subject;   ///< what was checked, such as "gyro unit"; unique in a report
  std::string text;      ///< one sentence
  std::string change{};  ///< proposed change; empty if none

  /// Another verdict, what else to say, and the change that it proposes.
  void judge(Verdict to, const std::string& more, std::string proposal) {
    verdict = to;
    text += more;
    change = std::move(proposal);
  }
};

using Findings = std::vector<Finding>;

/// The worst verdict.
inline Verdict worst(const Findings& findings) {
  Verdict verdict = Verdict::kOk;
  for (const Finding& f : findings) verdict = f.verdict > verdict ? f.verdict : verdict;
  return verdict;
}

/// Source of the recording, which determines the form of the proposed change.
enum class Source { kFolder, kBag };

}  // namespace rio::check
