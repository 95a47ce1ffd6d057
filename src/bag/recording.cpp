// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/recording.hpp"

#include <algorithm>
#include <deque>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>

#include "recording_sources.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

/// Gyroscope and accelerometer of two topics as one IMU: the force at the stamps of the rates, on
/// the line between its neighbours, unless they are so far apart that forces are missing.
class Halves {
 public:
  explicit Halves(Time interval)
      : longest_(std::max(kLongest, 5 * std::min(interval, 10 * kLongest))) {}
  void add(const ImuSample& sample, bool is_accel) {
    std::deque<ImuSample>& list = is_accel ? accels_ : gyros_;
    if (list.empty() || sample.time > list.back().time) list.push_back(sample);
  }
  bool next(ImuSample* sample) {
    while (!gyros_.empty() && accels_.size() > 1) {
      const ImuSample& a = accels_[0];
      const ImuSample& b = accels_[1];
      if (gyros_.front().time > b.time) {
        accels_.pop_front();
        continue;
      }
      *sample = gyros_.front();
      gyros_.pop_front();
      if (sample->time < a.time) continue;
      if (sample->time > a.time && b.time - a.time > longest_) continue;
      const double share = to_seconds(sample->time - a.time) / to_seconds(b.time - a.time);
      sample->accel_B = a.accel_B + share * (b.accel_B - a.accel_B);
      return true;
    }
    return false;
  }

 private:
  static constexpr Time kLongest{100'000'000};  ///< a drone may turn its motion around meanwhile
  Time longest_;
  std::deque<ImuSample> gyros_;
  std::deque<ImuSample> accels_;
};

/// Samples in the order of their stamps, if some come late; else in that of the file.
class InOrder {
 public:
  explicit InOrder(Time late) : late_(late) {}
  void add(const ImuSample& sample) {
    held_.emplace(late_ > Time(0) ? sample.time : Time(0), sample);
  }
  /// @param at_end no more will come
  bool next(ImuSample* sample, bool at_end) {
    if (held_.empty()) return false;
    const auto first = held_.begin();
    if (!at_end && std::prev(held_.end())->first - first->first < late_) return false;
    *sample = first->second;
    held_.erase(first);
    return true;
  }

 private:
  Time late_;
  std::multimap<Time, ImuSample> held_;
};

/// One reader for all topics: it buffers messages read before they are requested. If the topics are
/// far apart in the file, each sensor gets its own reader.
class BagStream final : public io::RecordingStream {
 public:
  BagStream(fs::path path, RecordingRequest request)
      : path_(std::move(path)),
        request_(std::move(request)),
        survey_(survey(path_, request_)),
        imu_(survey_) {
    outline_ = std::move(survey_.outline);
    start_over();
  }

 private:
  static constexpr std::size_t kMostSamples = 4096;  ///< limit of the buffer
  static constexpr std::size_t kMostScans = 64;

  /// The messages of a sensor.
  template <class Item>
  struct Sensor {
    std::unique_ptr<MessageStream> own{};  ///< null: uses the common reader
    std::deque<Item> waiting{};
    std::size_t met = 0;  ///< messages of the sensor read
  };
  struct Imu : Sensor<ImuSample> {
    std::size_t readable = 0;
    std::size_t readable_accel = 0;  ///< on its own topic
    InOrder samples;
    InOrder accels;
    Halves halves;

    explicit Imu(const Surveyed& survey)
        : samples(survey.imu.late),
          accels(survey.accel ? survey.accel->late : Time(0)),
          halves(survey.accel ? survey.accel->interval : Time(0)) {}
  };
  struct Radar : Sensor<RadarScan> {
    CloudReader clouds;
    std::size_t readable = 0;
    std::size_t scan = 0;                    ///< next one of the outline
    std::map<std::size_t, RadarScan> early;  ///< those behind it

    explicit Radar(const PointRequest& points) : clouds(points) {}
  };

  bool read(ImuSample* sample) override {
    if (!wait_for(imu_)) return false;
    *sample = imu_.waiting.front();
    imu_.waiting.pop_front();
    return true;
  }

  bool read(RadarScan* scan, std::size_t radar) override {
    if (!wait_for(radars_[radar])) return false;
    std::swap(*scan, radars_[radar].waiting.front());
    radars_[radar].waiting.pop_front();
    return true;
  }

  bool read(io::BaroSample* sample) override {
    if (baro_ == survey_.baro.size()) return false;
    *sample = survey_.baro[baro_++];
    return true;
  }

  void start_over() override {
    common_.reset();
    imu_ = Imu(survey_);
    radars_.clear();
    for (std::size_t r = 0; r < survey_.radars.size(); ++r) radars_.emplace_back(request_.points);
    baro_ = 0;
  }

  bool is_of_imu(const Topic& topic) const {
    return survey_.imu.role.fits(topic) || (survey_.accel && survey_.accel->role.fits(topic));
  }

  /// Reads until there is one; false at the end of the file.
  template <class Item>
  bool wait_for(const Sensor<Item>& sensor) {
    Message message;
    if (!common_) common_ = open_messages(path_);
    while (sensor.waiting.empty()) {
      MessageStream* from = reader_of(sensor);
      if (!from->next(&message)) {
        if (static_cast<const void*>(&sensor) == &imu_) give_samples(true);
        return !sensor.waiting.empty();
      }
      const Topic& topic = from->topics()[message.topic];
      if (from == reader_of(imu_) && is_of_imu(topic)) take_imu(topic, message);
      for (std::size_t r = 0; r < radars_.size(); ++r) {
        const Role& role = survey_.radars[r].role;
        if (from != reader_of(radars_[r]) || !role.fits(topic)) continue;
        take_scan(r, topic, message);
        if (radars_[r].waiting.size() > kMostScans) {
          read_apart(&radars_[r], [&role](const Topic& t) { return role.fits(t); });
        }
      }
      if (imu_.waiting.size() > kMostSamples) {
        read_apart(&imu_, [this](const Topic& t) { return is_of_imu(t); });
      }
    }
    return true;
  }

  template <class Item>
  MessageStream* reader_of(const Sensor<Item>& sensor) const {
    return sensor.own ? sensor.own.get() : common_.get();
  }

  void take_imu(const Topic& topic, const Message& message) {
    ++imu_.met;
    const bool is_accel = survey_.accel && survey_.accel->role.fits(topic);
    const Surveyed::Imu& of = is_accel ? *survey_.accel : survey_.imu;
    try {
      const ImuMessage read = imu_message(topic, message, request_);
      const std::size_t i = is_accel ? imu_.readable_accel++ : imu_.readable++;
      ImuSample sample = read.sample;
      sample.time = of.stamping.stamp(read.header.stamp, message.received, i);
      if (!survey_.accel && read.absent) return;
      (is_accel ? imu_.accels : imu_.samples).add(sample);
      give_samples(false);
    } catch (const Damage&) {  // already noted by the survey
    }
  }

  void give_samples(bool at_end) {
    ImuSample sample;
    while (imu_.accels.next(&sample, at_end)) imu_.halves.add(sample, true);
    while (imu_.samples.next(&sample, at_end)) {
      if (survey_.accel) imu_.halves.add(sample, false);
      if (!survey_.accel) imu_.waiting.push_back(sample);
    }
    while (imu_.halves.next(&sample)) imu_.waiting.push_back(sample);
  }

  void take_scan(std::size_t r, const Topic& topic, const Message& message) {
    Radar& radar = radars_[r];
    const std::vector<std::optional<std::size_t>>& place = survey_.radars[r].place;
    ++radar.met;
    try {
      RadarScan scan;
      (void)radar.clouds.read(topic, message, &scan.detections);
      const std::size_t i = radar.readable++;
      if (i >= place.size() || !place[i]) return;
      scan.time = outline_.scan_times[r][*place[i]];
      radar.early.emplace(*place[i], std::move(scan));
      for (auto next = radar.early.begin(); next != radar.early.end() && next->first == radar.scan;
           ++radar.scan) {
        radar.waiting.push_back(std::move(next->second));
        next = radar.early.erase(next);
      }
    } catch (const Damage&) {  // already noted by the survey
    }
  }

  /// Switches to an own reader, which first skips what the common one has read.
  template <class Item, class Fits>
  void read_apart(Sensor<Item>* sensor, const Fits& fits) {
    if (sensor->own) return;
    sensor->own = open_messages(path_);
    Message message;
    for (std::size_t met = 0; met < sensor->met && sensor->own->next(&message);) {
      met += fits(sensor->own->topics()[message.topic]) ? 1U : 0U;
    }
  }

  fs::path path_;
  RecordingRequest request_;
  Surveyed survey_;
  std::unique_ptr<MessageStream> common_;
  Imu imu_;
  std::deque<Radar> radars_;
  std::size_t baro_ = 0;
};

}  // namespace

std::unique_ptr<io::RecordingStream> open_recording(const fs::path& path,
                                                    const RecordingRequest& request) {
  return std::make_unique<BagStream>(path, request);
}

std::vector<NavState> read_truth(const fs::path& path, bool positions, const std::string& topic) {
  RecordingRequest request;
  request.truth_topic = topic;
  request.truth = true;
  request.positions = positions;
  try {
    std::vector<NavState> states = survey(path, request).outline.sensors.ground_truth;
    if (!states.empty()) return states;
  } catch (const std::runtime_error&) {  // no recording of a flight
  }
  Sources sources(path, request);
  const std::vector<Source*> found = sources.with_messages(sources.truth_role());
  if (found.empty()) {
    sources.fail("no topic {}{}of type {} or {}{}", topic, topic.empty() ? "" : " ", kPoseType,
                 kOdometryType,
                 positions ? fmt::format(", nor {} or {}", kPointType, kFixType) : "");
  }
  const std::string& name = found[0]->role.name;
  const auto is_the_same = [&found](const Source* other) {  // as the poses and odometry of rio
    return std::ranges::equal(
        found[0]->truth, other->truth,
        [](const NavState& a, const NavState& b) { return a.time == b.time && a.p_WB == b.p_WB; });
  };
  const auto other = std::ranges::find_if_not(found, is_the_same);
  if (other != found.end()) {
    sources.fail("several topics with {}, {} and {}; choose with --truth-topic, or --topic",
                 found[0]->role.type == kPointType ? "positions" : "poses", name,
                 (*other)->role.name);
  }
  std::vector<NavState> states;
  for (const NavState& state : found[0]->truth) {
    if (states.empty() || state.time > states.back().time) states.push_back(state);
  }
  if (states.empty()) {
    sources.fail("no readable message on {}; the first one, {}", name, found[0]->first_error);
  }
  return states;
}

io::Dataset read_recording(const fs::path& path, const RecordingRequest& request) {
  BagStream stream(path, request);
  return io::collect(&stream);
}

}  // namespace rio::bag
