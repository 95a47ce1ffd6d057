// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/config_sender.hpp"

#include <algorithm>
#include <utility>

#include "config_commands.hpp"

namespace rio::ti {
namespace {

constexpr char kPrompt[] = ":/>";
constexpr std::size_t kMostAnswer = 8192;  // longer without a prompt: another device

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// The lines of an answer except the echo and the prompt, joined.
std::string said(const std::string& answer, const std::string& echo) {
  std::string out;
  std::size_t begin = 0;
  while (begin < answer.size()) {
    const std::size_t end = std::min(answer.find_first_of("\r\n", begin), answer.size());
    const std::string line = answer.substr(begin, end - begin);
    begin = end + 1;
    if (line.empty() || line == echo || has(line, kPrompt)) continue;
    out += (out.empty() ? "" : "; ") + line;
  }
  return out;
}

}  // namespace

ConfigSender::ConfigSender(Config config, Time timeout)
    : config_(std::move(config)), timeout_(timeout) {}

const ConfigCommand* ConfigSender::current() const {
  return next_ == 0 || next_ > config_.commands.size() ? nullptr : &config_.commands[next_ - 1];
}

std::string ConfigSender::to_send(Time now) {
  if (over()) return {};
  if (waiting_ && !give_up_waiting(now)) return {};
  const std::string line = current() == nullptr ? "" : line_of(*current());
  if (line.size() > kMaxLine) {
    fail("longer than the radar reads, " + std::to_string(kMaxLine) + " characters");
    return {};
  }
  waiting_ = true;
  sent_ = now;
  answer_.clear();
  return line + "\n";
}

/// A missing answer to the empty line is no error.
/// @return true if the next line may be sent
bool ConfigSender::give_up_waiting(Time now) {
  if (now - sent_ <= (next_ == 0 ? timeout_ / 10 : timeout_)) return false;
  if (next_ == 0) {
    ++next_;
    return true;
  }
  fail(answer_.empty() ? "no answer: is this the CLI port, at its baud rate?"
                       : "no prompt after \"" + said(answer_, {}) + "\"");
  return false;
}

void ConfigSender::receive(const std::uint8_t* bytes, std::size_t count) {
  if (!waiting_ || over()) return;
  for (std::size_t i = 0; i < count; ++i) answer_ += static_cast<char>(bytes[i]);
  if (has(answer_, kPrompt)) {
    judge(answer_);
  } else if (answer_.size() > kMostAnswer) {
    fail("bytes without a prompt: is this the CLI port?");
  }
}

void ConfigSender::judge(const std::string& answer) {
  const ConfigCommand* command = current();
  if (command != nullptr) {
    const bool refused = has(answer, "Error") || has(answer, "not recognized");
    if (refused && command->name != "sensorStop") {
      return fail("the radar says \"" + said(answer, line_of(*command)) + "\"");
    }
    if (!refused && !has(answer, "Done") && !has(answer, "Skipped")) return;  // a stale prompt
    ++accepted_;
  }
  ++next_;
  waiting_ = false;
}

void ConfigSender::fail(const std::string& why) {
  const ConfigCommand* command = current();
  error_ = command == nullptr
               ? why
               : "line " + std::to_string(command->line) + ", " + command->name + ": " + why;
}

}  // namespace rio::ti
