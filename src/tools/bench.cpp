// SPDX-License-Identifier: BSD-3-Clause
// `rio bench`: cost of the estimator on this machine.
#include <fmt/format.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/measure.hpp"
#include "commands.hpp"
#include "outputs.hpp"
#include "rio/rio.hpp"

namespace rio::tools {

namespace {

using bench::Figures;

struct Row {
  std::string preset;
  BackEnd backend;
  Figures figures;
};

const char* name_of(BackEnd backend) {
  return backend == BackEnd::kEkf ? "ekf" : "smoother";
}

/// Peak of this program, including the load [MB].
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::vector<Row> measure_all(const BenchArguments& arguments) {
  const io::Dataset load = bench::make_load(arguments.detections, arguments.seconds);
  std::vector<Row> rows;
  for (const char* preset : kPresets) {
    for (const BackEnd backend : {BackEnd::kEkf, BackEnd::kSmoother}) {
      Options options = bench::options_for(load, preset, backend);
      options.frontend.max_detections = static_cast<int>(arguments.detections);
      rows.push_back({preset, backend, bench::measure(load, options)});
    }
  }
  return rows;
}

void print(const std::vector<Row>& rows) {
  fmt::print("{:<21} {:<9} {:>6} {:>9} {:>12} {:>9} {:>13} {:>11} {:>11} {:>11}\n", "preset",
             "back-end", "points", "landmarks", "update [ms]", "p99 [ms]", "IMU step [us]",
             "create [ms]", "memory [MB]", "x real time");
  for (const Row& row : rows) {
    const Figures& f = row.figures;
    fmt::print(
        "{:<21} {:<9} {:>6.1f} {:>9.1f} {:>12.3f} {:>9.3f} {:>13.2f} {:>11.2f} {:>11.2f} "
        "{:>11.0f}\n",
        row.preset, name_of(row.backend), f.detections, f.landmarks, 1e-3 * f.update.median,
        1e-3 * f.update.p99, f.imu_step, 1e-3 * f.create, static_cast<double>(f.memory) / (1 << 20),
        f.real_time);
  }
  fmt::print(
      "\nCPU times of one core, in flight. update: of a scan, front-end to promotion. IMU step: "
      "with\n"
      "its covariance. create: before the first sample. memory: all of it allocated there;\n"
      "sizeof(Odometry) is {} bytes, and {:.0f} MB the most this program took, the simulated "
      "flight\n"
      "included. x real time: all calls.\n",
      sizeof(Odometry), peak_memory());
}

void print_json(const std::vector<Row>& rows) {
  nlohmann::json all = {{"peak_rss_mb", peak_memory()}, {"sizeof_odometry", sizeof(Odometry)}};
  for (const Row& row : rows) {
    const Figures& f = row.figures;
    all["rows"].push_back({{"preset", row.preset},
                           {"backend", name_of(row.backend)},
                           {"updates", f.updates},
                           {"detections", f.detections},
                           {"clones", f.clones},
                           {"landmarks", f.landmarks},
                           {"update_median_ms", 1e-3 * f.update.median},
                           {"update_p99_ms", 1e-3 * f.update.p99},
                           {"imu_step_us", f.imu_step},
                           {"create_ms", 1e-3 * f.create},
                           {"memory_bytes", f.memory},
                           {"real_time_factor", f.real_time}});
  }
  fmt::print("{}\n", all.dump());
}

void print(const std::vector<bench::Growth>& growths, bool as_json) {
  nlohmann::json all;
  for (const bench::Growth& growth : growths) {
    if (!as_json) fmt::print("{}\n", growth.size);
    for (const bench::GrowthCurve& curve : growth.curves) {
      for (const auto& [size, median, p99] : curve.points) {  // [us]
        all[growth.title][curve.label].push_back(
            {{"size", size}, {"update_median_ms", 1e-3 * median}, {"update_p99_ms", 1e-3 * p99}});
        if (as_json) continue;
        fmt::print("  {:<28} {:>7.1f} {:>9.3f} ms, p99 {:.3f}\n", curve.label, size, 1e-3 * median,
                   1e-3 * p99);
      }
    }
  }
  if (as_json) fmt::print("{}\n", all.dump());
}

}  // namespace

void measure_cost(const BenchArguments& arguments) {
  if (!arguments.growth) {
    const std::vector<Row> rows = measure_all(arguments);
    arguments.json ? print_json(rows) : print(rows);
    return;
  }
  const std::vector<bench::Growth> growths = bench::measure_growth(arguments.seconds);
  if (!arguments.out.empty()) write_text(arguments.out, bench::growth_chart(growths));
  print(growths, arguments.json);
}

}  // namespace rio::tools
