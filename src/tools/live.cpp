// SPDX-License-Identifier: BSD-3-Clause
// `rio live`: sensors on ports through the estimator. One thread: poll, read, estimate, send.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "live/host_clock.hpp"
#include "live/mavlink_link.hpp"
#include "live/outputs.hpp"
#include "live/port.hpp"
#include "live/session.hpp"
#include "live_imu.hpp"
#include "live_ports.hpp"
#include "live_summary.hpp"
#include "outputs.hpp"
#include "stop_signal.hpp"
#include "view_outputs.hpp"

namespace rio::tools {

namespace {

using live::MavlinkLink;
using live::Port;

constexpr int kImuBaud = 921600;
constexpr Time kImuPause = std::chrono::seconds(1);  // a longer one is told; of its clock, too

/// On stderr: events, and, on a terminal, a status line that is updated twice a second. The
/// terminal may be lost.
class Screen {
 public:
  void say(const std::string& message) {
    clear();
    std::fprintf(stderr, "%s\n", message.c_str());
  }
  bool due() {
    const Time now = live::HostClock::real();
    if (!is_terminal_ || now - last_ < std::chrono::milliseconds(500)) return false;
    last_ = now;
    return true;
  }
  void show(const std::string& line) {
    clear();
    std::fputs(line.c_str(), stderr);
    shown_ = true;
  }
  void clear() {
    if (shown_) std::fputs("\r\x1b[K", stderr);
    shown_ = false;
  }

 private:
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
  Time last_{0};
};

/// Why no byte came; empty if that is not known.
std::string why_silent(const Port& port) {
  if (port.state() == Port::State::kAbsent) return port.name() + " is not there";
  return port.state() == Port::State::kEnded ? port.name() + " has ended without a byte" : "";
}

class LiveRun {
 public:
  explicit LiveRun(const LiveArguments& arguments)
      : arguments_(arguments),
        clock_(arguments.speed),
        imu_(arguments.imu_format),
        summary_(clock_),
        files_{live::EstimateFiles(arguments.out, "", ""),
               live::EstimateFiles("", arguments.states, ""),
               live::EstimateFiles("", "", arguments.json_lines)},
        view_(arguments.view),
        watches_(arguments.radars.size()),
        ports_(clock_, arguments.patience, std::bind_front(&Screen::say, &screen_)) {
    LiveSensors sensors = find_sensors(arguments);
    for (const std::string& to : arguments.record) {
      if (to.ends_with(".mcap")) {
        mcap_recorders_.emplace_back(to, arguments.radars.size());
      } else {
        recorders_.emplace_back(to, sensors.info);
      }
    }
    add_links(sensors.setup.options.imu, sensors.info.imu_info.rate_hz.value_or(200.0));
    std::vector<live::Listener*> listeners;
    if (link_) listeners.push_back(&*link_);  // first, since the autopilot waits
    listeners.push_back(&summary_);
    for (live::EstimateFiles& file : files_) listeners.push_back(&file);
    if (view_.any()) listeners.push_back(&view_);
    view_.begin({"Live run", sensors.setup.options, {}, true, RIO_VERSION});
    for (live::Recorder& recorder : recorders_) listeners.push_back(&recorder);
    for (live::McapRecorder& recorder : mcap_recorders_) listeners.push_back(&recorder);
    session_.emplace(sensors.setup, std::move(listeners));
    add_radars(sensors.setup);
    for (const std::string& cli : arguments.cli) send_config(cli, sensors.config);
  }

  void run() {
    while (stop_requested == 0 && ports_.wait()) {
      if (link_) link_->tick(*session_, clock_.now());
      if (link_ && link_->host_offset()) session_->tell_host_offset(*link_->host_offset());
      watch();
      if (screen_.due()) screen_.show(summary_.line(*session_));
    }
    session_->end();
    watch();
    screen_.clear();
    ports_.close();  // one of them may be the CLI port, too
    for (const std::string& cli : arguments_.cli) stop_radar(cli);
  }

  /// Prints the summary.
  /// @throws WrongResult if the estimate is lost, std::runtime_error if there is none
  void conclude() {
    std::vector<std::string> radar_ports;
    for (const Port* port : radar_ports_) radar_ports.push_back(why_silent(*port));
    const bool lost = summary_.conclude(*session_, radar_ports, imu_counters(), imu_problem(),
                                        link_ ? link_->sent() : 0);
    fmt::print("{}", arguments_.json ? summary_.json() + "\n" : summary_.text());
    view_.close(summary_.replay());
    if (lost) throw WrongResult("the estimate is lost: " + summary_.lost_because());
    std::string failed = summary_.without_scans();
    const auto fail = [&failed](const std::string& why) {
      failed += (failed.empty() ? "" : "; ") + why;
    };
    if (session_->imu_samples() == 0) {
      fail(imu_problem());
    } else if (!session_->odometry().initialized()) {
      fail("no start: " + imu_.why_no_start());
    } else if (summary_.replay().updates == 0 && failed.empty()) {
      const std::string of_imu = imu_problem();
      fail("no scan gave an update: " +
           (of_imu.empty() ? "their points or times are of no use, see the counters" : of_imu));
    }
    if (!session_->failed().empty()) fail(session_->failed());
    if (!failed.empty()) throw std::runtime_error(failed);
  }

 private:
  void watch() {
    for (std::size_t r = 0; r < watches_.size(); ++r) {
      const std::string message = watches_[r].look(session_->reader(r), live::HostClock::real(),
                                                   session_->times_problem(r));
      if (!message.empty()) screen_.say(fmt::format("radar {}: {}", r, message));
    }
    if (session_->failed() != failed_)
      screen_.say((failed_ = session_->failed()) + ": left out from here on");
    const bool wrong = session_->imu_silence() > kImuPause || imu_clock_is_wrong();
    if (wrong != imu_wrong_) screen_.say(wrong ? imu_problem() : "samples of the IMU again");
    imu_wrong_ = wrong;
  }

  bool imu_clock_is_wrong() const {
    return std::chrono::abs(session_->imu_stamps_off()) > kImuPause;
  }

  /// Why samples are missing or of no use; empty if neither.
  std::string imu_problem() const {
    if (session_->imu_samples() == 0) {
      return "no sample of the IMU" + imu_.why_no_sample(link_ ? link_->received() : "");
    }
    const Time silence = session_->imu_silence();
    if (silence > kImuPause) {
      return fmt::format("no sample of the IMU for {:.1f} s", to_seconds(silence));
    }
    if (!imu_clock_is_wrong()) return {};
    return fmt::format(
        "the stamps of the IMU are {:.1f} s off this machine's clock: --imu-clock own",
        to_seconds(session_->imu_stamps_off()));
  }

  /// The ports of the IMU and of the autopilot, which may be the same.
  void add_links(const ImuOptions& imu, double imu_rate) {
    const bool same = imu_.is_mavlink() && arguments_.mavlink == arguments_.imu;
    Port* to_autopilot = nullptr;
    if (imu_.is_mavlink()) {
      to_autopilot = &add_mavlink_port("IMU", arguments_.imu, true);
    } else {
      ports_.add(
          {Port(arguments_.imu, kImuBaud), "IMU", true, std::bind_front(&LiveRun::take_imu, this)});
    }
    if (!arguments_.mavlink.empty() && !same) {
      if (imu_.is_mavlink()) {
        throw std::runtime_error("--mavlink must be the port of --imu where that is an autopilot");
      }
      to_autopilot = &add_mavlink_port("autopilot", arguments_.mavlink, false);
    }
    if (to_autopilot == nullptr) return;
    MavlinkLink::Settings settings;
    settings.rate = arguments_.mavlink.empty() ? 0.0 : arguments_.mavlink_rate;
    settings.content = arguments_.velocity_only        ? mavlink::Content::kVelocity
                       : arguments_.velocity_when_lost ? mavlink::Content::kAllOrVelocity
                                                       : mavlink::Content::kAll;
    settings.system = static_cast<std::uint8_t>(arguments_.mavlink_system);
    settings.raw_imu = arguments_.imu_format == "mavlink-raw";
    settings.asks_clock = imu_.is_mavlink();
    settings.gyro_sigma = imu.gyro_noise_density * std::sqrt(imu_rate);
    // a full line drops the message: the next is newer
    link_.emplace(settings, std::bind_front(&Port::write, to_autopilot));
  }

  Port& add_mavlink_port(const char* what, const std::string& name, bool needed) {
    return ports_.add({Port(name, kImuBaud), what, needed,
                       [this](const std::uint8_t* bytes, std::size_t count, Time arrival) {
                         if (imu_.is_mavlink()) take_imu(bytes, count, arrival);
                         link_->receive(bytes, count, arrival, [&](const ImuSample& sample) {
                           if (imu_.is_mavlink()) give_imu(sample, arrival);
                         });
                       }});
  }

  void add_radars(const live::SessionSetup& setup) {
    for (std::size_t r = 0; r < arguments_.radars.size(); ++r) {
      radar_ports_.push_back(&ports_.add(
          {Port(arguments_.radars[r], static_cast<int>(setup.radars[r].baud)),
           fmt::format("radar {}", r), true, std::bind_front(&live::Session::radar, &*session_, r),
           std::bind_front(&live::Session::radar_reopened, &*session_, r)}));
    }
  }

  void give_imu(const ImuSample& sample, Time arrival) {
    session_->imu(sample, arrival);
    if (session_->odometry().initialized()) return;
    if (const std::string message = imu_.wait(sample); !message.empty()) screen_.say(message);
  }

  void take_imu(const std::uint8_t* bytes, std::size_t count, Time arrival) {
    imu_.take(bytes, count, arrival, [&](const ImuSample& sample) { give_imu(sample, arrival); });
  }

  live::ImuCounters imu_counters() const {
    if (imu_.is_mavlink()) return {session_->imu_samples(), 0, link_->counters().damaged};
    return imu_.counters();
  }

  const LiveArguments& arguments_;
  live::HostClock clock_;
  ImuPort imu_;
  Screen screen_;
  LiveSummary summary_;
  live::EstimateFiles files_[3];  ///< one that fails does not end the others
  ViewOutputs view_;
  std::list<live::Recorder> recorders_;
  std::list<live::McapRecorder> mcap_recorders_;
  std::vector<live::ScanWatch> watches_;
  bool imu_wrong_ = false;  ///< and it was told
  std::string failed_;      ///< outputs, and it was told
  live::PortSet ports_;
  std::vector<const Port*> radar_ports_;
  std::optional<MavlinkLink> link_;
  std::optional<live::Session> session_;
};

}  // namespace

void live(const LiveArguments& arguments) {
  if (!arguments.cli.empty() && arguments.cli.size() != arguments.radars.size()) {
    throw std::runtime_error("--cli: as many ports as there are radars");
  }
  std::vector<std::string> ports = {arguments.imu};
  ports.insert(ports.end(), arguments.radars.begin(), arguments.radars.end());
  ports.insert(ports.end(), arguments.cli.begin(), arguments.cli.end());
  std::vector<std::string> inputs = {arguments.sensors, arguments.estimator.config,
                                     arguments.radar_cfg};
  for (const std::string& port : ports) inputs.push_back(Port(port, kImuBaud).path());
  std::vector<std::string> outputs = arguments.record;
  for (std::string& file : files_of(arguments.view)) outputs.push_back(std::move(file));
  outputs.insert(outputs.end(), {arguments.out, arguments.states, arguments.json_lines});
  protect_inputs(inputs, outputs);
  catch_stop_signals();
  LiveRun run(arguments);
  run.run();
  run.conclude();
}

}  // namespace rio::tools
