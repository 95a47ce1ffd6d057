// SPDX-License-Identifier: BSD-3-Clause
// `rio replay`: a recording through the estimator, as a flight stack would feed it.
#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "commands.hpp"
#include "findings.hpp"
#include "live/host_clock.hpp"
#include "outputs.hpp"
#include "recording.hpp"
#include "replay.hpp"
#include "replay_run.hpp"
#include "rio/aiding.hpp"
#include "rio/models/aids.hpp"

namespace rio::tools {

namespace {

/// What is free goes back to the system, now and, of large blocks, from now on, where the C library
/// can do so.
void give_back_memory() {
#ifdef __GLIBC__
  constexpr int kLarge = 64 * 1024;  // [bytes]
  (void)mallopt(M_MMAP_THRESHOLD, kLarge);
  (void)malloc_trim(0);
#endif
}

Options make_options(const ReplayArguments& arguments, const io::Dataset& sensors,
                     std::vector<std::string>* notes) {
  Options base;
  if (arguments.barometer) (void)base.auxiliary.declare<HeightOffset>();
  Options options = io::flown_options(arguments.estimator, sensors, base, notes);
  options.timing.clock = &live::HostClock::real;
  return options;
}

}  // namespace

Replayed run_replay(const ReplayArguments& arguments, ViewOutputs* view, const OnScan& on_scan) {
  std::vector<std::string> outputs = files_of(arguments.view);
  outputs.insert(outputs.end(), {arguments.out, arguments.states});
  protect_inputs({arguments.dataset, arguments.estimator.config, arguments.init, arguments.how.map,
                  arguments.how.sensors},
                 outputs);
  const OpenRecording recording =
      open_any(arguments.dataset, arguments.how, arguments.init == "groundtruth");
  std::vector<std::string> notes = recording.sensors.notes;
  const Options options = make_options(arguments, recording.sensors, &notes);
  Options checked;  // overridden values have been noted already
  (void)io::tell_sensors_and_values(recording.sensors, arguments.estimator, &checked);
  check::ClockSteps steps;
  if (!arguments.no_check)
    steps = find_clock_steps(recording.samples.get(), recording.sensors, checked, &notes);
  if (!arguments.silent) print_notes(notes);  // at once
  recording.samples->rewind();
  ReplaySummary summary = fly(arguments, recording, options, std::move(steps), view, on_scan);
  if (!arguments.no_check && arguments.findings) {
    give_back_memory();  // of the estimator and the feed
    const CheckedPart part = read_checked_part(recording.samples.get(), recording.sensors);
    summary.data = not_ok(findings_of(arguments.dataset, part.data, checked));
    if (summary.initialised_by != "static") without_start(&*summary.data);
    summary.checked_seconds = part.seconds;
  }
  const std::string& damage = recording.samples->outline().sensors.damage;
  if (!summary.started) {
    view->close(summary);  // complete, if without an estimate
    throw std::runtime_error(no_start_text(summary.data) + (damage.empty() ? "" : "\n" + damage));
  }
  return {std::move(summary), std::move(notes), damage};
}

void replay(const ReplayArguments& arguments) {
  ViewOutputs view(arguments.view);
  const Replayed replayed = run_replay(arguments, &view);
  const ReplaySummary& summary = replayed.summary;
  if (summary.data && worst(*summary.data) == check::Verdict::kWrong) {
    fmt::print(stderr, "note: something is wrong with the recording; see `rio check`\n");
  }
  fmt::print("{}", arguments.json ? summary.json() + "\n" : summary.text());
  view.close(summary);
  if (summary.health.lost()) {
    throw WrongResult(fmt::format(
        "the estimate is lost: {}; fastest {:.3g} m/s, farthest {:.3g} m; check units, axes, "
        "mounting, the start and pauses of a sensor",
        summary.health.lost_because(), summary.fastest, summary.farthest));
  }
  throw_damage(replayed.damage);
  if (summary.updates == 0) {
    throw std::runtime_error("no scan gave an update: the path is that of the IMU alone");
  }
}

}  // namespace rio::tools
