// SPDX-License-Identifier: BSD-3-Clause
// A flight as on a flight controller: no heap but a static array, a stack of known size, the filter
// with few landmarks. Prints what of both was used, and fails if the estimate is not where the
// vehicle is, or allocates after create().
#include <pthread.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "rio/rio.hpp"
#include "rio/static_memory.hpp"

namespace {

/// All memory of the program.
alignas(64) std::array<unsigned char, 4U << 20> memory;

constexpr std::size_t kStack = 512U << 10;
alignas(4096) std::array<unsigned char, kStack> stack;
constexpr unsigned char kPaint = 0xA5;

/// Bytes of the stack that the call uses, on the thread below.
template <class Call>
[[gnu::noinline]] std::size_t stack_of(const Call& call) {
  constexpr std::ptrdiff_t kOfPainting = 1024;  // frames of this function and of memset
  auto* const here = static_cast<unsigned char*>(__builtin_frame_address(0));
  std::memset(stack.data(), kPaint, static_cast<std::size_t>(here - stack.data() - kOfPainting));
  call();
  const unsigned char* deepest = stack.data();
  while (deepest < here && *deepest == kPaint) ++deepest;
  return static_cast<std::size_t>(here - deepest);
}

/// Runs the function on that stack.
void on_stack(void* (*function)(void*), void* argument) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstack(&attributes, stack.data(), stack.size());
  pthread_t thread{};
  if (pthread_create(&thread, &attributes, function, argument) != 0) std::abort();
  pthread_join(thread, nullptr);
}

constexpr double kRest = 2.0;      // [s]
constexpr double kSeconds = 20.0;  // of flight
constexpr int kPoints = 30;        // in a scan

/// To and fro on a figure of eight, level; at rest before.
struct Truth {
  rio::Vector3d p = rio::Vector3d::Zero(), v = rio::Vector3d::Zero(), a = rio::Vector3d::Zero();
  explicit Truth(double t) {
    if (t < kRest) return;
    const double s = t - kRest;
    axis(0, 3.0, 0.5, s);
    axis(1, 2.0, 1.0, s);
    axis(2, 0.5, 0.7, s);
  }
  /// A (1 - cos w s)^2, which begins at rest and without a step of the acceleration.
  void axis(int i, double amplitude, double w, double s) {
    const double c = std::cos(w * s), n = std::sin(w * s);
    p[i] = amplitude * (1.0 - c) * (1.0 - c);
    v[i] = amplitude * 2.0 * (1.0 - c) * n * w;
    a[i] = amplitude * 2.0 * w * w * (n * n + (1.0 - c) * c);
  }
};

/// In [0, 1), the same on every machine.
double random_number() {
  static std::uint32_t state = 1;
  state = state * 1664525U + 1013904223U;
  return static_cast<double>(state >> 8) / 16777216.0;
}
double noise(double sigma) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random_number();
  return sigma * sum;
}

/// Points of the world in front of the radar.
void scan_of(const Truth& truth, rio::RadarScan* scan) {
  scan->detections.resize(kPoints);
  for (rio::RadarDetection& d : scan->detections) {
    const double azimuth = (random_number() - 0.5) * 1.6, elevation = (random_number() - 0.5) * 0.6;
    const double range = 2.0 + 6.0 * random_number();
    const rio::Vector3d u(std::cos(elevation) * std::cos(azimuth),
                          std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    d.point_S = range * u;
    d.range_rate = -u.dot(truth.v) + noise(0.03);
    d.snr_db = 25.0;
  }
}

struct Flight {
  std::unique_ptr<rio::Odometry> odometry;
  rio::Options options;
  rio::RadarScan scan;
  std::size_t memory = 0;                             ///< of the estimator [bytes]
  std::size_t allocated_later = 0;                    ///< after create() [bytes]
  std::size_t creating = 0, of_imu = 0, of_scan = 0;  ///< stack of a call, the most [bytes]
};

void fly(Flight* flight) {
  constexpr double kImuRate = 200.0;
  constexpr int kEvery = 13;  // samples in a scan, 15 Hz
  rio::Odometry& odometry = *flight->odometry;
  for (int i = 0; i < static_cast<int>((kRest + kSeconds) * kImuRate); ++i) {
    const double t = i / kImuRate;
    const Truth truth(t);
    rio::ImuSample sample;
    sample.time = rio::from_seconds(1.0 + t);
    sample.gyro_B = {noise(0.002), noise(0.002), noise(0.002)};
    sample.accel_B = truth.a + rio::Vector3d(noise(0.02), noise(0.02), 9.81 + noise(0.02));
    flight->of_imu = std::max(flight->of_imu, stack_of([&] { (void)odometry.add_imu(sample); }));
    if (i % kEvery != 0) continue;
    scan_of(truth, &flight->scan);
    flight->scan.time = sample.time;
    flight->of_scan =
        std::max(flight->of_scan, stack_of([&] { (void)odometry.add_scan(flight->scan); }));
  }
}

void* create_and_fly(void* argument) {
  auto* const flight = static_cast<Flight*>(argument);
  flight->scan.detections.reserve(kPoints);
  std::string why;
  const std::size_t before = rio::static_memory::used();
  flight->creating =
      stack_of([&] { flight->odometry = rio::Odometry::create(flight->options, &why); });
  flight->memory = rio::static_memory::used() - before;
  if (flight->odometry == nullptr) {
    std::printf("%s\n", why.c_str());
    return nullptr;
  }
  fly(flight);
  flight->allocated_later = rio::static_memory::used() - before - flight->memory;
  return nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  rio::static_memory::give(memory.data(), memory.size());
  static Flight flight;
  flight.options.update.max_landmarks = argc > 1 ? std::atoi(argv[1]) : 8;
  flight.options.update.use_landmarks = flight.options.update.max_landmarks > 0;
  flight.options.frontend.max_detections = 64;
  flight.options.timing.imu_buffer = 128;
  on_stack(&create_and_fly, &flight);
  if (flight.odometry == nullptr) return 1;
  const double error = (flight.odometry->now().p_WB - Truth(kRest + kSeconds - 0.005).p).norm();
  std::printf(
      "memory %zu bytes; stack %zu bytes in create(), %zu in add_imu(), %zu in add_scan()\n",
      flight.memory, flight.creating, flight.of_imu, flight.of_scan);
  std::printf("%lld scans, %s, %.2f m off after %.0f s\n",
              static_cast<long long>(flight.odometry->counters().scans),
              to_string(flight.odometry->health().state), error, kSeconds);
  const bool good = error < 1.0 && flight.odometry->counters().scans > 200;
  return good && flight.allocated_later == 0 ? 0 : 1;
}
