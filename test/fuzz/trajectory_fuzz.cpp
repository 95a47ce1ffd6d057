// SPDX-License-Identifier: BSD-3-Clause
// Trajectory files, TUM and csv: finite poses with rising stamps, or a std::runtime_error that
// names the file.
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/io/trajectory.hpp"
#include "support/temp_dir.hpp"

namespace {

void read(const std::filesystem::path& path) {
  rio::io::Trajectory trajectory;
  const auto read_it = [&] { trajectory = rio::io::read_trajectory(path); };
  if (!rio::fuzz::reads(path.string(), read_it)) return;
  RIO_FUZZ_CHECK(!trajectory.empty());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    RIO_FUZZ_CHECK(trajectory[i].p.allFinite());
    RIO_FUZZ_CHECK(std::abs(trajectory[i].q.norm() - 1.0) < 1e-9);
    RIO_FUZZ_CHECK(i == 0 || trajectory[i - 1].time < trajectory[i].time);
    RIO_FUZZ_CHECK(!rio::io::tum_line(trajectory[i]).empty());
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rio::test::TempDir dir;
  const std::string text = rio::fuzz::text_of(data, size);
  read(dir.write("trajectory.tum", text));
  read(dir.write("trajectory.csv", text));
  return 0;
}
