// SPDX-License-Identifier: BSD-3-Clause
// The pieces of code in data/docs/library.md, word for word between the markers
// (readme_example.cmake): compiled, not run.
#include <rio/aiding.hpp>
#include <rio/mavlink/frame.hpp>
#include <rio/mavlink/odometry.hpp>
#include <rio/models/aids.hpp>
#include <rio/rio.hpp>
#include <rio/ti/frame_clock.hpp>
#include <rio/ti/packet_reader.hpp>

// clang-format off
namespace readme {

void aids(rio::Options options, rio::Status status, rio::Time time, double height, double sigma) {
  // [README aids]
  options.auxiliary.declare<rio::HeightOffset>();          // a state of its own: prior, random walk
  auto odometry = rio::Odometry::create(options);
  status = odometry->add_measurement({time, rio::HeightModel{}, {height, sigma}});  // in any order
  double drift = rio::auxiliary<rio::HeightOffset>(*odometry)->value[0];
  // [README aids]
}

void radars(rio::Options options, const rio::Pose& T_BS_of_the_second, rio::Odometry* odometry,
            const rio::RadarScan& scan, rio::Status status) {
  // [README radars]
  options.other_radars.push_back({T_BS_of_the_second});  // up to three more; of another kind: .kind
  status = odometry->add_scan(scan, 1);                  // radar 0 is the one of options.radar
  // [README radars]
}

void ti(rio::Odometry* odometry, const std::uint8_t* bytes, std::size_t count, rio::Time now) {
  // [README ti]
  rio::ti::FrameTiming timing;
  timing.period = std::chrono::microseconds(66667);        // of the radar's configuration
  timing.chirp_block = std::chrono::microseconds(18500);
  rio::ti::FrameClock clock(timing);
  rio::ti::PacketReader reader;
  const auto on_frame = [&](rio::ti::Frame& frame) {
    frame.scan.time = clock.stamp(frame);                  // the middle of the chirp block
    rio::Status status = odometry->add_scan(frame.scan);   // of every frame
  };
  // whenever bytes were read, in pieces of any size; now: when, in the clock of the IMU's stamps
  reader.push(bytes, count, now, on_frame);
  reader.flush(on_frame);                                  // when none has come for some milliseconds
  // [README ti]
}

void mavlink(rio::Odometry* odometry, const rio::ImuSample& sample,
             void (*send)(const std::uint8_t* bytes, std::size_t count)) {
  // [README mavlink]
  rio::mavlink::Writer writer;                             // system 1, component 197
  rio::mavlink::RateLimiter limiter(30.0);                 // [Hz]
  std::uint8_t buffer[rio::mavlink::kMaxFrame];
  if (limiter.due(odometry->now().time)) {                 // after each IMU sample
    const auto message = rio::mavlink::odometry_message(odometry->now(), odometry->covariance_now(),
                                                        odometry->health(), sample.gyro_B);
    if (message) send(buffer, writer.write(*message, buffer, sizeof buffer));
  }
  // [README mavlink]
}

}  // namespace readme
