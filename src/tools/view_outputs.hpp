// SPDX-License-Identifier: BSD-3-Clause
// What a run is shown in: the sinks of its record that the command line asks for.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "replay_summary.hpp"
#include "view/messages.hpp"
#include "view/record.hpp"
#include "view/report.hpp"

namespace rio::view {
class LiveServer;
}

namespace rio::tools {

class ViewOutputs {
 public:
  /// Throws std::runtime_error if something cannot be written.
  explicit ViewOutputs(const ViewArguments& arguments);

  /// Another one, which must outlive this.
  void add_sink(view::RunSink* sink) { recorder_.add_sink(sink); }

  bool any() const { return recorder_.any(); }
  void begin(const view::RunStart& start) { recorder_.begin(start); }
  /// After a scan was processed.
  void add(const Odometry& odometry) { recorder_.add(odometry); }
  /// Completes the files; the report with the verdict and the figures of the summary.
  void close(const ReplaySummary& summary);

 private:
  void send_to(std::unique_ptr<view::MessageTarget> target);
  void serve(const ViewArguments& arguments);
  void tell_dropped() const;

  std::string report_path_;
  view::ReportBuilder* report_ = nullptr;  ///< among the sinks
  view::LiveServer* server_ = nullptr;     ///< among the targets
  std::vector<std::unique_ptr<view::MessageTarget>> targets_;
  std::vector<std::unique_ptr<view::RunSink>> sinks_;
  view::RunRecorder recorder_;
};

}  // namespace rio::tools
