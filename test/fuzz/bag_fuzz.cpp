// SPDX-License-Identifier: BSD-3-Clause
// Recordings of ROS in any of the formats: a data set, whatever of it is readable, or a
// std::runtime_error that says why not; bounded time and memory.
#include <sys/resource.h>

#include <stdexcept>
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/bag/recording.hpp"
#include "rio/bag/summary.hpp"
#include "rio/testing/allocation_guard.hpp"
#include "support/temp_dir.hpp"

namespace {

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rio::test::TempDir dir;
  static const double at_start = peak_megabytes();
  const std::string text = rio::fuzz::text_of(data, size);
  const std::string file = dir.write("recording", text);
  try {
    const rio::io::Dataset recording = rio::bag::read_recording(file, {});
    RIO_FUZZ_CHECK(!recording.imu.empty());
    const auto summary = rio::bag::summarise(rio::bag::open_messages(file).get());
    RIO_FUZZ_CHECK(!rio::bag::summary_text(summary).empty());
  } catch (const std::runtime_error& error) {
    RIO_FUZZ_CHECK(!std::string(error.what()).empty());
  }
  constexpr bool kSanitised = !rio::test::AllocationGuard::kWorks;
  RIO_FUZZ_CHECK(kSanitised || peak_megabytes() - at_start < 64.0);
  return 0;
}
