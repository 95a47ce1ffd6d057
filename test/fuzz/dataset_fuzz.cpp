// SPDX-License-Identifier: BSD-3-Clause
// Recordings in the ASL layout, csv and sensor.yaml: what is read can be written and reads back the
// same, or a std::runtime_error; and sequences with a file per scan. The input is the files one
// after the other, each after a line "=== NAME".
#include <filesystem>
#include <span>
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/scan_folder.hpp"
#include "support/temp_dir.hpp"

namespace {

namespace fs = std::filesystem;

constexpr const char* kNames[] = {"imu0/data.csv",   "imu0/sensor.yaml",
                                  "radar0/data.csv", "radar0/sensor.yaml",
                                  "baro0/data.csv",  "state_groundtruth_estimate0/data.csv"};

/// Of sequences; the last names are no stamps.
constexpr const char* kSequenceNames[] = {"imu/imu_data.txt",
                                          "imu/timestamps.txt",
                                          "single_chip/pointclouds/timestamps.txt",
                                          "single_chip/pointclouds/data/radar_pointcloud_0.bin",
                                          "sensor_data/xsens_imu.csv",
                                          "Radar/Continental/1700000000000000000.bin",
                                          "Radar/Continental/9999999999999999999.bin",
                                          "Radar/Continental/-999999999999999999.bin"};

/// The part of the input that is the file; empty if there is none.
std::string part(const std::string& text, const std::string& name) {
  const std::string head = "=== " + name + "\n";
  const std::size_t found = text.find(head);
  if (found == std::string::npos) return {};
  const std::size_t begin = found + head.size();
  return text.substr(begin, text.find("=== ", begin) - begin);
}

void write(const rio::test::TempDir& dir, std::span<const char* const> names,
           const std::string& text) {
  fs::remove_all(dir.path() / "in");
  fs::create_directories(dir.path() / "in");
  for (const char* name : names) {
    const std::string content = part(text, name);
    if (!content.empty()) dir.write(std::string("in/") + name, content);
  }
}

void check_reads_back(const rio::test::TempDir& dir, const rio::io::Dataset& data) {
  for (const char* folder : {"once", "twice"}) fs::remove_all(dir.path() / folder);
  rio::io::write_dataset(dir.path() / "once", data);
  rio::io::write_dataset(dir.path() / "twice", rio::io::read_dataset(dir.path() / "once"));
  for (const char* name : kNames) {
    if (std::string(name).find("data.csv") == std::string::npos) continue;
    RIO_FUZZ_CHECK(dir.read(std::string("once/") + name) == dir.read(std::string("twice/") + name));
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rio::test::TempDir dir;
  const std::string text = rio::fuzz::text_of(data, size);
  const fs::path in = dir.path() / "in";
  rio::io::Dataset dataset;
  write(dir, kSequenceNames, text);
  const auto read_sequence = [&] {
    dataset = rio::io::collect(rio::io::open_scan_folder(in).get());
  };
  if (rio::io::is_scan_folder(in) && rio::fuzz::reads(in, read_sequence)) {
    RIO_FUZZ_CHECK(!dataset.imu.empty() && !dataset.scans.empty());
  }
  write(dir, kNames, text);
  if (!rio::fuzz::reads(in, [&] { dataset = rio::io::read_dataset(in); })) return 0;
  RIO_FUZZ_CHECK(!dataset.imu.empty() && !dataset.scans.empty());
  rio::Options options;
  rio::io::apply_sensor_info(dataset, &options);
  check_reads_back(dir, dataset);
  return 0;
}
