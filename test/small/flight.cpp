// SPDX-License-Identifier: BSD-3-Clause
// A flight as on a flight controller: no heap but a static array that is only ever filled, a stack
// of known size, the filter with few landmarks. Prints what of both was used, and fails if the
// estimate is not where the vehicle is.
#include <pthread.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "rio/rio.hpp"

namespace {

/// All memory of the estimator. On a controller this is the heap of the linker script.
alignas(64) std::array<unsigned char, 4U << 20> arena;
std::size_t used = 0;
bool open = false;  ///< only while the estimator is created
long late = 0;      ///< allocations after that

void* take(std::size_t size, std::size_t align) {
  const std::size_t at = (used + align - 1) / align * align;
  if (at + size > arena.size()) std::abort();
  used = at + size;
  if (!open) ++late;
  return arena.data() + at;
}

constexpr std::size_t kStack = 512U << 10;
alignas(4096) std::array<unsigned char, kStack> stack;
constexpr unsigned char kPaint = 0xA5;

/// Runs the function on a painted stack; what it used of it.
std::size_t stack_of(void* (*function)(void*), void* argument) {
  std::memset(stack.data(), kPaint, stack.size());
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstack(&attributes, stack.data(), stack.size());
  pthread_t thread{};
  if (pthread_create(&thread, &attributes, function, argument) != 0) std::abort();
  pthread_join(thread, nullptr);
  std::size_t untouched = 0;
  while (untouched < stack.size() && stack[untouched] == kPaint) ++untouched;
  return stack.size() - untouched;
}

constexpr double kPi = 3.14159265358979323846;
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
};

void* create(void* argument) {
  auto* flight = static_cast<Flight*>(argument);
  std::string why;
  flight->scan.detections.reserve(kPoints);
  open = true;
  flight->odometry = rio::Odometry::create(flight->options, &why);
  open = false;
  if (flight->odometry == nullptr) std::printf("%s\n", why.c_str());
  return nullptr;
}

void* fly(void* argument) {
  auto* flight = static_cast<Flight*>(argument);
  late = 0;  // starting the thread is not the estimator's
  constexpr double kImuRate = 200.0;
  constexpr int kEvery = 13;  // samples in a scan, 15 Hz
  for (int i = 0; i < static_cast<int>((kRest + kSeconds) * kImuRate); ++i) {
    const double t = i / kImuRate;
    const Truth truth(t);
    rio::ImuSample sample;
    sample.time = rio::from_seconds(1.0 + t);
    sample.gyro_B = {noise(0.002), noise(0.002), noise(0.002)};
    sample.accel_B = truth.a + rio::Vector3d(noise(0.02), noise(0.02), 9.81 + noise(0.02));
    (void)flight->odometry->add_imu(sample);
    if (i % kEvery != 0) continue;
    scan_of(truth, &flight->scan);
    flight->scan.time = sample.time;
    (void)flight->odometry->add_scan(flight->scan);
  }
  return nullptr;
}

}  // namespace

// Everything that asks for memory ends here, Eigen, too.
extern "C" {
void* malloc(std::size_t size) {
  return take(size, 16);
}
void* calloc(std::size_t count, std::size_t size) {
  return take(count * size, 16);  // the arena is zero, and no byte of it is given twice
}
void* realloc(void* from, std::size_t size) {
  void* to = take(size, 16);
  if (from != nullptr) std::memcpy(to, from, size);
  return to;
}
void free(void*) {}
void* aligned_alloc(std::size_t align, std::size_t size) {
  return take(size, align);
}
int posix_memalign(void** to, std::size_t align, std::size_t size) {
  *to = take(size, align);
  return 0;
}
}

int main(int argc, char** argv) {
  static Flight flight;
  flight.options.update.max_landmarks = argc > 1 ? std::atoi(argv[1]) : 8;
  flight.options.update.use_landmarks = flight.options.update.max_landmarks > 0;
  flight.options.frontend.max_detections = 64;
  flight.options.timing.imu_buffer = 128;
  const std::size_t before = used;
  const std::size_t creating = stack_of(&create, &flight);
  if (flight.odometry == nullptr) return 1;
  const std::size_t memory = used - before;
  const std::size_t flying = stack_of(&fly, &flight);
  const long while_flying = late;
  const double error = (flight.odometry->now().p_WB - Truth(kRest + kSeconds - 0.005).p).norm();
  std::printf(
      "memory %zu bytes, stack %zu bytes in create(), %zu bytes in flight; %ld allocations in "
      "flight\n",
      memory, creating, flying, while_flying);
  std::printf("%lld scans, %s, %.2f m off after %.0f s\n",
              static_cast<long long>(flight.odometry->counters().scans),
              to_string(flight.odometry->health().state), error, kSeconds);
  const bool good = error < 1.0 && flight.odometry->counters().scans > 200;
  return good ? 0 : 1;
}
