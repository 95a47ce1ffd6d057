// SPDX-License-Identifier: BSD-3-Clause
// What a run is shown in: the sinks that the command line asks for; and what a replay writes at
// each scan.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "live/session.hpp"
#include "replay_summary.hpp"
#include "rio/io/text_file.hpp"
#include "rio/io/trajectory.hpp"
#include "view/messages.hpp"
#include "view/report.hpp"
#include "view/run.hpp"

namespace rio::tools {

/// Writes the page; what is missing in it is noted on stderr.
void write_report(const view::Page& page, const std::string& path);

class ViewOutputs : public live::Listener {
 public:
  /// Throws std::runtime_error if something cannot be written.
  explicit ViewOutputs(const ViewArguments& arguments);

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
  void add_sink(std::unique_ptr<view::RunSink> sink) { sinks_.push_back(std::move(sink)); }

  std::string report_path_;
  view::ReportBuilder* report_ = nullptr;  ///< among the sinks
  view::LiveServer* server_ = nullptr;     ///< of a sink
  std::vector<std::unique_ptr<view::RunSink>> sinks_;
  view::EventWatch watch_;
};

/// What a replay writes at each processed scan: trajectory, states, a line for the terminal; of
/// scans at the same instant, as of several radars, after the last one.
class ScanOutputs {
 public:
  void open(const ReplayArguments& arguments, Time begin) {
    begin_ = begin;
    lines_ = arguments.verbose && !arguments.json && !arguments.quiet;
    if (!arguments.out.empty()) trajectory_.emplace(arguments.out);
    if (!arguments.states.empty()) states_.emplace(arguments.states);
  }

  bool prints_lines() const { return lines_; }

  void add(const Odometry& odometry) {
    const NavState& state = odometry.at_scan();
    if (newest_ && newest_->state.time != state.time) write();
    newest_ = {state, odometry.covariance()};
    if (lines_) print_line(state, odometry.report());
  }

  void close() {
    if (newest_) write();
    if (trajectory_) trajectory_->close();
    if (states_) states_->close();
  }

 private:
  struct Line {
    NavState state;
    BodyCovariance covariance;
  };

  void write() {
    const NavState& x = newest_->state;
    if (trajectory_) trajectory_->write(io::tum_line({x.time, x.p_WB, x.q_WB}) + "\n");
    if (states_) states_->add(x, newest_->covariance);
  }

  void print_line(const NavState& state, const UpdateReport& report) const {
    int used = 0;
    int gated = 0;
    for (const ModelReport& model : report.models) {
      used += model.rows_used;
      gated += model.rows_gated;
    }
    fmt::print(
        "{:9.3f} s  position {:8.3f} {:8.3f} {:8.3f} m  speed {:6.3f} m/s  points {:3} static {:3} "
        " rows {:3} gated {:3}\n",
        to_seconds(state.time - begin_), state.p_WB.x(), state.p_WB.y(), state.p_WB.z(),
        state.v_WB.norm(), report.detections_kept, report.static_detections, used, gated);
  }

  Time begin_{0};
  bool lines_ = false;
  std::optional<Line> newest_;  ///< not written yet
  std::optional<io::TextFile> trajectory_;
  std::optional<io::StatesFile> states_;
};

}  // namespace rio::tools
