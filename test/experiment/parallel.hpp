// SPDX-License-Identifier: BSD-3-Clause
// A loop over independent jobs on a few threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace rio::experiment {

/// Called with the number of finished jobs and their total, never by two threads at a time.
using OnProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Calls job(0) .. job(count - 1), each once, in any order. The first exception stops the loop
/// after the running jobs and is rethrown.
template <class Job>
void parallel_for(std::size_t count, int threads, const OnProgress& on_progress, const Job& job) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::size_t done = 0;
  std::exception_ptr error;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        job(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next = count;
        return;
      }
      const std::lock_guard lock(mutex);
      ++done;
      if (on_progress) on_progress(done, count);
    }
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace rio::experiment
