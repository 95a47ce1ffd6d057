// SPDX-License-Identifier: BSD-3-Clause
// What a run is shown in: the sinks that the command line asks for; and what a replay writes at
// each scan.
#pragma once

#include <fmt/format.h>

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "live/session.hpp"
#include "plot/svg.hpp"
#include "replay_summary.hpp"
#include "rio/io/trajectory.hpp"
#include "view/messages.hpp"
#include "view/report.hpp"
#include "view/run.hpp"

namespace rio::tools {

/// Writes the page; what is missing in it is noted on stderr.
void write_report(const view::Page& page, const std::string& path);

/// The files that a run with these arguments writes.
std::vector<std::string> files_of(const ViewArguments& arguments);

class ViewOutputs : public live::Listener {
 public:
  explicit ViewOutputs(const ViewArguments& arguments) : arguments_(arguments) {}

  bool any() const { return !files_of(arguments_).empty() || !arguments_.port.empty(); }
  /// Opens the files: what a run that fails before has written earlier is kept.
  /// @throws std::runtime_error if something cannot be written
  void begin(view::RunStart start);
  /// After a scan was processed.
  void add(const Odometry& odometry);
  /// After a sample of the IMU.
  void watch(const Odometry& odometry);
  void on_imu(const live::Session& session, const ImuSample& sample) override {
    if (report_ != nullptr) report_->begin_at(sample.time);
    watch(session.odometry());
  }
  void on_estimate(const live::Session& session, Time /*arrival*/) override {
    add(session.odometry());
  }
  /// Completes the files; the report with the verdict and the figures of the summary.
  /// @throws what a sink has thrown, which was told and left out from then on
  void close(const ReplaySummary& summary);

 private:
  struct Sink {
    std::unique_ptr<view::RunSink> to;
    std::exception_ptr failed{};
  };
  /// An estimate beside this one.
  struct Other {
    std::string label;
    Time begin;
    Time end;
  };

  void open();
  void add_sink(std::unique_ptr<view::RunSink> sink) { sinks_.push_back({std::move(sink)}); }
  void tell(const std::vector<view::Event>& events);
  template <class Call>
  void for_each_sink(const Call& call);

  ViewArguments arguments_;
  view::ReportBuilder* report_ = nullptr;  ///< among the sinks
  view::LiveServer* server_ = nullptr;     ///< of a sink
  std::vector<Sink> sinks_;
  std::vector<Other> others_;
  std::optional<Time> begin_;  ///< first scan
  Time end_{0};                ///< newest scan
  view::EventWatch watch_;
};

/// What a replay writes at each processed scan: trajectory, states, a line for the terminal.
class ScanOutputs {
 public:
  ScanOutputs(const ReplayArguments& arguments, Time begin)
      : begin_(begin),
        lines_(arguments.verbose && !arguments.json && !arguments.quiet),
        path_(arguments.out, arguments.states) {}

  bool prints_lines() const { return lines_; }

  void add(const Odometry& odometry) {
    path_.add(odometry.at_scan(), odometry.covariance());
    if (lines_) print_line(odometry.at_scan(), odometry.report());
  }

  void close() { path_.close(); }

 private:
  void print_line(const NavState& state, const UpdateReport& report) const {
    int used = 0;
    int gated = 0;
    for (const ModelReport& model : report.models) {
      used += model.rows_used;
      gated += model.rows_gated;
    }
    fmt::print(
        "{:9.3f} s  position {:>8} {:>8} {:>8} m  speed {:6.3f} m/s  points {:3} static {:3} "
        " rows {:3} gated {:3}\n",
        to_seconds(state.time - begin_), plot::fixed(state.p_WB.x(), 3),
        plot::fixed(state.p_WB.y(), 3), plot::fixed(state.p_WB.z(), 3), state.v_WB.norm(),
        report.detections_kept, report.static_detections, used, gated);
  }

  Time begin_;
  bool lines_;
  io::PathFiles path_;
};

}  // namespace rio::tools
