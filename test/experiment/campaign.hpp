// SPDX-License-Identifier: BSD-3-Clause
// Many trials: cases (a scenario and a seed) times variants (a preset and a change of its options),
// and tables of them; and a loop over independent jobs on a few threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "experiment/score.hpp"
#include "experiment/spread.hpp"
#include "rio/sim/scenario.hpp"

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

/// One flight.
struct Case {
  std::string group;  ///< cases of one group share the rows of a table
  sim::Scenario scenario;
};
using Cases = std::vector<Case>;

/// `count` flights of a named scenario with seeds first, first + 1, ...
/// @throws std::runtime_error if the catalogue has no such scenario
Cases cases_of(const std::string& name, int count, std::uint64_t first = 1);

/// `each` flights of each of the seven lengths of the paper of 2023, `indoor-1` to `indoor-7`.
Cases indoor_cases(int each);

using Change = std::function<void(Options&)>;

/// One estimator.
struct Variant {
  std::string name;
  std::string preset;
  Change change{};  ///< applied to the preset, if set
};
using Variants = std::vector<Variant>;

/// The presets that experiments compare, the best first.
inline const Variants& presets_compared() {
  static const Variants presets = {{"default", "default"}, {"published-ekf", "published-ekf"}};
  return presets;
}

/// Options of the variant's preset with the sensors of the flight and its change.
Options options_of(const sim::Flight& flight, const Variant& variant);

struct Outcome {
  std::string group;
  std::uint64_t seed = 0;
  std::string variant;
  Score score;
};
using Outcomes = std::vector<Outcome>;

struct Settings {
  int seeds = 0;  ///< flights of a kind; 0 = the default of the experiment
  int threads = 2;
  std::string data{};  ///< folder of the recordings, for experiments on real ones
  OnProgress on_progress{};
  std::string dataset{};  ///< name of the data set, for `benchmark`

  int seeds_or(int usual) const { return seeds > 0 ? seeds : usual; }
};

/// Called with each trial before it is discarded, never by two threads at a time.
using EachTrial = std::function<void(const Case&, const Variant&, const Trial&)>;

/// Flies every case with every variant. Runs come by case, then by variant.
Outcomes run_campaign(const Cases& cases, const Variants& variants, const Settings& settings,
                      const EachTrial& each = {});

/// The runs of a variant in the groups whose names begin so: "indoor" for all lengths, "" for all.
Scores select(const Outcomes& runs, std::string_view group, std::string_view variant);

int count_lost(const Scores& scores);

/// All figures of all runs, a row per run.
std::string outcomes_as_csv(const Outcomes& runs);

/// A column over the runs of an estimator, beside those of a reference in the same flights.
struct Column {
  std::string head;
  std::function<std::string(const Scores& scores, const Scores& reference)> cell;
};
/// "mean (worst) ± std".
Column spread_of(const std::string& head, double Score::*value, int decimals);
Column mean_of(const std::string& head, double Score::*value, int decimals);
/// Increase over the reference: "+0.12 ± 0.03", the mean of the differences and its standard error.
Column change_of(const std::string& head, double Score::*value, int decimals);
/// Mean NEES of position, heading and velocity.
Column nees_of(const std::string& head, int decimals);
Column lost_of(const std::string& head);

/// The cells of `names`, then of the columns.
std::vector<std::string> row_of(std::vector<std::string> names, const std::vector<Column>& columns,
                                const Scores& scores, const Scores& reference = {});

/// Heads of leading cells and columns.
std::vector<std::string> head_of(std::vector<std::string> names,
                                 const std::vector<Column>& columns);

}  // namespace rio::experiment
