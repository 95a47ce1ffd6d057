// SPDX-License-Identifier: BSD-3-Clause
// Recordings in the ASL layout, csv and sensor.yaml: what is read can be written and reads back the
// same, or a std::runtime_error. The input is the files one after the other, each after a line
// "=== NAME".
#include <filesystem>
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/io/dataset.hpp"
#include "support/temp_dir.hpp"

namespace {

namespace fs = std::filesystem;

constexpr const char* kNames[] = {"imu0/data.csv",   "imu0/sensor.yaml",
                                  "radar0/data.csv", "radar0/sensor.yaml",
                                  "baro0/data.csv",  "state_groundtruth_estimate0/data.csv"};

/// The part of the input that is the file; empty if there is none.
std::string part(const std::string& text, const std::string& name) {
  const std::string head = "=== " + name + "\n";
  const std::size_t found = text.find(head);
  if (found == std::string::npos) return {};
  const std::size_t begin = found + head.size();
  return text.substr(begin, text.find("=== ", begin) - begin);
}

void write(const rio::test::TempDir& dir, const std::string& folder, const std::string& text) {
  fs::remove_all(dir.path() / folder);
  for (const char* name : kNames) {
    const std::string content = part(text, name);
    if (!content.empty()) dir.write(folder + "/" + name, content);
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
  write(dir, "in", text);
  fs::create_directories(dir.path() / "in");
  rio::io::Dataset dataset;
  const auto read = [&] { dataset = rio::io::read_dataset(dir.path() / "in"); };
  if (!rio::fuzz::reads(dir.path().string(), read)) return 0;
  RIO_FUZZ_CHECK(!dataset.imu.empty() && !dataset.scans.empty());
  rio::Options options;
  rio::io::apply_sensor_info(dataset, &options);
  check_reads_back(dir, dataset);
  return 0;
}
