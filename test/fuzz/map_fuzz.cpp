// SPDX-License-Identifier: BSD-3-Clause
// The short files of the tools, `--map` and `--init`: finite values, or a std::runtime_error that
// names the file.
#include <cmath>
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/bag/recording.hpp"
#include "rio/io/start.hpp"
#include "support/temp_dir.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rio::test::TempDir dir;
  const std::string text = rio::fuzz::text_of(data, size);
  const std::string file = dir.write("file.yaml", text);
  rio::fuzz::reads(file + ":", [&] {
    const rio::bag::RecordingRequest request = rio::bag::load_recording_map(file);
    for (const double value :
         {request.imu_offset, request.radar_offset, request.gyro_unit, request.accel_unit}) {
      RIO_FUZZ_CHECK(std::isfinite(value));
    }
  });
  rio::fuzz::reads(file + ":", [&] {
    const rio::Alignment start = rio::io::load_start(file, {}, rio::Time{0});
    RIO_FUZZ_CHECK(start.state.p_WB.allFinite() && start.state.v_WB.allFinite());
    RIO_FUZZ_CHECK(std::abs(start.state.q_WB.norm() - 1.0) < 1e-9);
    RIO_FUZZ_CHECK(start.covariance.allFinite());
  });
  return 0;
}
