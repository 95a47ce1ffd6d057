// SPDX-License-Identifier: BSD-3-Clause
// A replay reads while it goes on: its memory does not depend on the length of the recording.
#include <gtest/gtest.h>

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <vector>

#include "e2e/tool.hpp"
#include "rio/testing/allocation_guard.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

struct Replay {
  double peak = 0.0;  ///< resident memory [MB]
  Json summary;
};

class Memory : public Tool {
 protected:
  static constexpr double kMost = 32.0;   // [MB], 2 of them libraries of the live view
  static constexpr double kGrowth = 3.0;  // [MB]: stamps, and times of the scans for the median

  /// Of a process of its own, whose peak begins with the memory of this one.
  static Replay replay(const std::string& arguments) {
    const std::string out = file("out.json");
    const std::string command =
        "exec " RIO_TOOL " replay " + arguments + " --init static --json >" + out + " 2>/dev/null";
    malloc_trim(0);  // what other tests have freed
    const pid_t pid = fork();
    if (pid == 0) {
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    int status = 0;
    rusage usage{};
    EXPECT_EQ(wait4(pid, &status, 0, &usage), pid);
    // where one flight ends and the next begins the estimate may be lost: status 3
    EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 3));
    std::ifstream text(out);
    return {static_cast<double>(usage.ru_maxrss) / 1024.0, Json::parse(text, nullptr, false)};
  }

  /// The rows of a file again and again, each time later by `period`; after `dense` one stamp of
  /// fifteen alone [ns].
  static void repeat(const fs::path& from, const fs::path& to, std::int64_t period,
                     std::int64_t duration, std::int64_t dense) {
    const std::vector<std::string> rows = lines_of(from);
    fs::create_directories(to.parent_path());
    std::ofstream out(to);
    const std::int64_t begin = std::stoll(rows.front());
    std::int64_t changes = 0;
    for (std::int64_t shift = 0; shift < duration; shift += period) {
      std::int64_t last = 0;
      for (const std::string& row : rows) {
        const std::size_t comma = row.find(',');
        const std::int64_t time = std::stoll(row) + shift;
        if (time - begin >= duration) break;
        changes += time != last ? 1 : 0;
        last = time;
        if (time - begin >= dense && changes % 15 != 0) continue;
        out << time << row.substr(comma) << '\n';
      }
    }
  }

  /// The flight repeated, to save time with one of fifteen scans after the first minutes.
  static std::string long_flight(const std::string& name, std::int64_t minutes,
                                 std::int64_t dense) {
    const std::int64_t minute = 60'000'000'000;
    const fs::path from = flight_;
    const fs::path to = file(name);
    const std::vector<std::string> imu = lines_of(from / "imu0/data.csv");
    const std::int64_t period = std::stoll(imu.back()) - std::stoll(imu.front()) + 5'000'000;
    for (const auto& [sensor, all] : {std::pair("imu0", minutes), {"radar0", dense}}) {
      repeat(from / sensor / "data.csv", to / sensor / "data.csv", period, minutes * minute,
             all * minute);
      fs::copy(from / sensor / "sensor.yaml", to / sensor / "sensor.yaml");
    }
    return to;
  }
};

TEST_F(Memory, IsThatOfAShortFlight) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "a sanitizer has memory of its own";
  const Replay minute = replay(long_flight("one", 1, 1) + " --no-check");
  const Replay unchecked = replay(long_flight("five", 5, 5) + " --no-check");
  const Replay checked = replay(long_flight("eleven", 11, 10));
  const Replay hour = replay(long_flight("hour", 60, 10));
  measured("memory of a minute, unchecked, MB", minute.peak, "");
  measured("memory of five minutes, unchecked, MB", unchecked.peak, "");
  measured("memory of eleven minutes, MB", checked.peak, "below 32");
  expect_below("memory of an hour, MB", hour.peak, kMost);
  EXPECT_LT(unchecked.peak, minute.peak + kGrowth);
  EXPECT_LT(hour.peak, checked.peak + kGrowth);

  EXPECT_NEAR(hour.summary["duration_s"].get<double>(), 3600.0, 0.1);
  EXPECT_GT(hour.summary["scans"].get<int>(), 10 * 60 * 14 + 50 * 60 / 2);
  // the begin is checked, and it is said
  EXPECT_NEAR(hour.summary["data_checked_s"].get<double>(), 600.0, 1.0);
  EXPECT_EQ(hour.summary["data"], checked.summary["data"]);
  EXPECT_FALSE(unchecked.summary.contains("data"));
}

TEST_F(Memory, TenMinutesAreCheckedAsAWhole) {
  const std::string ten = long_flight("ten", 10, 1);
  expect_none(try_rio("replay " + ten + " --init static").output, {"s are checked"});
  const std::string more = long_flight("more", 11, 1);
  expect_parts(try_rio("replay " + more + " --init static").output,
               {"data: the first 600 s are checked"});
}

}  // namespace
}  // namespace rio::test
