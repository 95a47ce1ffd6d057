// SPDX-License-Identifier: BSD-3-Clause
// What a run is shown in: the sinks of its record that the command line asks for.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "live/session.hpp"
#include "replay_summary.hpp"
#include "view/messages.hpp"
#include "view/record.hpp"
#include "view/report.hpp"

namespace rio::tools {

/// Writes the page; what is missing in it is noted on stderr.
void write_report(const view::Page& page, const std::string& path);

class ViewOutputs : public live::Listener {
 public:
  /// Throws std::runtime_error if something cannot be written.
  explicit ViewOutputs(const ViewArguments& arguments);

  void add_sink(std::unique_ptr<view::RunSink> sink) { sinks_.push_back(std::move(sink)); }

  bool any() const { return !sinks_.empty(); }
  void begin(const view::RunStart& start);
  /// After a scan was processed.
  void add(const Odometry& odometry);
  void on_estimate(const live::Session& session, Time /*arrival*/) override {
    add(session.odometry());
  }
  /// Completes the files; the report with the verdict and the figures of the summary.
  void close(const ReplaySummary& summary);

 private:
  std::string report_path_;
  view::ReportBuilder* report_ = nullptr;  ///< among the sinks
  view::LiveServer* server_ = nullptr;     ///< of a sink
  std::vector<std::unique_ptr<view::RunSink>> sinks_;
  view::ScanRecord record_;
  view::EventWatch watch_;
};

}  // namespace rio::tools
