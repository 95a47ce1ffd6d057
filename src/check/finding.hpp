// SPDX-License-Identifier: BSD-3-Clause
// What `rio check` says of a recording: a sentence with numbers, a verdict, and what to change.
#pragma once

#include <string>
#include <vector>

namespace rio::check {

enum class Verdict {
  kOk,
  kDoubtful,  ///< look at it; an estimate may still be good
  kWrong,     ///< no estimate of this recording is to be believed before it is changed
};

inline const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kWrong:
      return "wrong";
    default:
      return "ok";
  }
}

struct Finding {
  Verdict verdict = Verdict::kOk;
  std::string subject;  ///< what was looked at, such as "gyro unit"; unique in a report
  std::string text;     ///< one sentence
  std::string change;   ///< what to change; empty where there is nothing to be
};

using Findings = std::vector<Finding>;

/// The worst of all.
inline Verdict worst(const Findings& findings) {
  Verdict verdict = Verdict::kOk;
  for (const Finding& f : findings) verdict = f.verdict > verdict ? f.verdict : verdict;
  return verdict;
}

/// How a recording came in: what is to be changed is said accordingly.
enum class Source { kFolder, kBag };

}  // namespace rio::check
