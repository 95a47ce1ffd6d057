// SPDX-License-Identifier: BSD-3-Clause
#include "view_outputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "evaluate.hpp"
#include "outputs.hpp"
#include "rio/io/trajectory.hpp"
#include "view/calibration_names.hpp"
#include "view/csv_log.hpp"

namespace rio::tools {

namespace {

/// What to do about a parameter of the calibration that is not doubtful.
std::string advice(const CalibrationReport& c) {
  if (c.observability != Observability::kObserved) return "needs turns and changes of speed";
  return std::abs(c.value) > 3.0 * c.sigma ? "rio calibrate writes it into the sensor files" : "";
}

void fill_card(const ReplaySummary& summary, view::Page* page) {
  page->verdict = summary.health.verdict();
  std::vector<view::CardLine> card = {
      {"Duration", fmt::format("{:.1f} s, {} scans", to_seconds(summary.span), summary.scans)},
      {"Distance",
       fmt::format("{:.1f} m, at most {:.2f} m/s", summary.path_length, summary.fastest)},
      {"First to last position",
       fmt::format("{:.3f} m", (summary.last_position - summary.first_position).norm())}};
  card.insert(card.end(), page->card.begin(), page->card.end());
  card.push_back({"Start", summary.initialised_by});
  if (!summary.without_scans.empty()) card.push_back({"Scans", summary.without_scans});
  if (summary.wall > Time{0}) {
    card.push_back({"Real-time factor",
                    fmt::format("{:.0f} x", to_seconds(summary.span) / to_seconds(summary.wall))});
  }
  for (const auto& [name, unit, scale, c, check] : calibration_lines(summary.calibration)) {
    card.push_back({view::title_of(name),
                    fmt::format("{} {} ± {:.2f}, {}", plot::signed_fixed(scale * c.value, 2), unit,
                                scale * c.sigma, to_string(c.observability)),
                    check.empty() ? advice(c) : "check " + check});
  }
  if (summary.height_offset) {
    card.push_back({"Barometer", fmt::format("offset {} m ± {:.2f}, NIS {:.2f} a row",
                                             plot::signed_fixed(summary.height_offset->value[0], 2),
                                             std::sqrt(summary.height_offset->covariance(0, 0)),
                                             summary.height_nis())});
  }
  page->card = std::move(card);
  if (!summary.data || summary.data->empty()) return;
  view::Table found{"Doubts about the recording", {{"what", "", "found", "to do"}}};
  for (const check::Finding& f : *summary.data) {
    found.rows.push_back({f.subject, to_string(f.verdict), f.text, f.change});
  }
  page->tables.push_back(std::move(found));
}

}  // namespace

void write_report(const view::Page& page, const std::string& path) {
  for (const std::string& note : view::write_page(page, path)) {
    fmt::print(stderr, "note: {} is {}\n", path, note);
  }
}

std::vector<std::string> files_of(const ViewArguments& arguments) {
  std::vector<std::string> files;
  if (!arguments.report.empty()) files.push_back(arguments.report);
  if (!arguments.mcap.empty()) files.push_back(arguments.mcap);
  if (arguments.log.empty()) return files;
  for (const char* name : view::kLogFiles) {
    files.push_back((std::filesystem::path(arguments.log) / name).string());
  }
  return files;
}

void ViewOutputs::open() {
  const ViewArguments& arguments = arguments_;
  if (!arguments.port.empty()) {  // before a file is replaced
#ifdef RIO_HAS_LIBWEBSOCKETS
    const std::string address = arguments.address == "localhost" ? "127.0.0.1" : arguments.address;
    auto server = view::make_live_server(address, std::stoi(arguments.port));
    const bool is_v6 = address.find(':') != std::string::npos;
    fmt::print(stderr, "view: ws://{}:{} (Foxglove, Lichtblick: open connection)\n",
               is_v6 ? "[" + address + "]" : address, server->port());
    server_ = server.get();
    add_sink(std::make_unique<view::Messages>(std::move(server)));
#else
    throw std::runtime_error("--view: built without libwebsockets (package libwebsockets-dev)");
#endif
  }
  if (!arguments.report.empty()) {
    auto report = std::make_unique<view::ReportBuilder>();
    report_ = report.get();
    add_sink(std::move(report));
  }
  if (!arguments.log.empty()) add_sink(std::make_unique<view::CsvLog>(arguments.log));
  if (arguments.mcap.empty()) return;
  add_sink(std::make_unique<view::Messages>(std::make_unique<view::McapTarget>(arguments.mcap)));
}

void ViewOutputs::begin(view::RunStart start) {
  if (!arguments_.report.empty()) expect_folder(arguments_.report);
  const std::vector<std::string> labels = default_labels(arguments_.also);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    start.others.emplace_back(labels[i], io::read_trajectory(arguments_.also[i]));
    const eval::Trajectory& path = start.others.back().second;
    if (!path.empty()) others_.push_back({labels[i], path.front().time, path.back().time});
  }
  open();
  for (const Sink& sink : sinks_) sink.to->begin(start);
}

template <class Call>
void ViewOutputs::for_each_sink(const Call& call) {
  for (Sink& sink : sinks_) {
    if (sink.failed) continue;
    try {
      call(sink.to.get());
    } catch (const std::exception& error) {
      sink.failed = std::current_exception();
      fmt::print(stderr, "note: {}: left out from here on\n", error.what());
    }
  }
}

void ViewOutputs::tell(const std::vector<view::Event>& events) {
  for (const view::Event& event : events) {
    for_each_sink([&](view::RunSink* sink) { sink->add_event(event); });
  }
}

void ViewOutputs::add(const Odometry& odometry) {
  if (sinks_.empty()) return;
  const Time now = odometry.at_scan().time;
  if (!begin_) begin_ = now;
  end_ = now;
  tell(watch_.after_scan(odometry));
  for_each_sink([&](view::RunSink* sink) { sink->add(odometry); });
}

void ViewOutputs::watch(const Odometry& odometry) {
  if (!sinks_.empty() && odometry.initialized()) tell(watch_.after_imu(odometry));
}

void ViewOutputs::close(const ReplaySummary& summary) {
  for_each_sink([](view::RunSink* sink) { sink->close(); });
  for (const Other& other : others_) {
    if (begin_ && other.begin <= end_ && other.end >= *begin_) continue;
    fmt::print(stderr, "note: --also {}: no time in common with this run\n", other.label);
  }
  if (server_ != nullptr && server_->dropped() > 0) {
    fmt::print(stderr, "view: {} messages dropped, since viewers read too slowly\n",
               server_->dropped());
  }
  if (report_ != nullptr) {
    fill_card(summary, &report_->page());
    write_report(report_->page(), arguments_.report);
  }
  for (const Sink& sink : sinks_) {
    if (sink.failed) std::rethrow_exception(sink.failed);
  }
}

}  // namespace rio::tools
