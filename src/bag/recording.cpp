// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/recording.hpp"

#include <deque>
#include <optional>
#include <utility>

#include "recording_survey.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

/// One reader for both topics: it buffers messages read before they are requested. If the topics
/// are far apart in the file, each gets its own reader.
class BagStream final : public io::RecordingStream {
 public:
  BagStream(fs::path path, RecordingRequest request)
      : path_(std::move(path)), request_(std::move(request)), survey_(survey(path_, request_)) {
    outline_ = std::move(survey_.outline);
    start_over();
  }

 private:
  static constexpr std::size_t kMostSamples = 4096;  ///< limit of the buffer
  static constexpr std::size_t kMostScans = 64;

  /// The messages of a topic.
  template <class Item>
  struct Sensor {
    std::unique_ptr<MessageStream> own;  ///< null: uses the common reader
    std::deque<Item> waiting;
    std::size_t met = 0;       ///< messages of the topic read
    std::size_t readable = 0;  ///< of these, decodable
  };

  bool read(ImuSample* sample) override {
    if (!wait_for(imu_)) return false;
    *sample = imu_.waiting.front();
    imu_.waiting.pop_front();
    return true;
  }

  bool read(RadarScan* scan, std::size_t /*radar*/) override {
    if (!wait_for(radar_)) return false;
    std::swap(*scan, radar_.waiting.front());
    radar_.waiting.pop_front();
    return true;
  }

  bool read(io::BaroSample* /*sample*/) override { return false; }

  void start_over() override {
    common_.reset();
    imu_ = {};
    radar_ = {};
    clouds_.emplace(request_.points);
    scan_ = 0;
  }

  /// Reads until there is one; false at the end of the file.
  template <class Item>
  bool wait_for(const Sensor<Item>& sensor) {
    Message message;
    if (!common_) common_ = open_messages(path_);
    while (sensor.waiting.empty()) {
      MessageStream* from = reader_of(sensor);
      if (!from->next(&message)) return false;
      const Topic& topic = from->topics()[message.topic];
      if (from == reader_of(imu_) && survey_.imu.fits(topic)) take_imu(topic, message);
      if (from == reader_of(radar_) && survey_.radar.fits(topic)) take_scan(topic, message);
      if (imu_.waiting.size() > kMostSamples) read_apart(&imu_, survey_.imu);
      if (radar_.waiting.size() > kMostScans) read_apart(&radar_, survey_.radar);
    }
    return true;
  }

  template <class Item>
  MessageStream* reader_of(const Sensor<Item>& sensor) const {
    return sensor.own ? sensor.own.get() : common_.get();
  }

  void take_imu(const Topic& topic, const Message& message) {
    ++imu_.met;
    try {
      Header header;
      ImuSample sample = imu_sample(topic, message, request_, &header);
      sample.time = (survey_.imu_received ? message.received : header.stamp) + survey_.imu_shift;
      imu_.waiting.push_back(sample);
    } catch (const Damage&) {  // already noted by the survey
    }
  }

  void take_scan(const Topic& topic, const Message& message) {
    ++radar_.met;
    try {
      Header header;
      RadarScan scan;
      clouds_->read(topic, message, &header, &scan.detections, nullptr);
      const std::size_t i = radar_.readable++;
      if (i >= survey_.kept.size() || !survey_.kept[i]) return;
      scan.time = outline_.scan_times[0][scan_++];
      radar_.waiting.push_back(std::move(scan));
    } catch (const Damage&) {  // already noted by the survey
    }
  }

  /// Switches to an own reader, which first skips what the common one has read.
  template <class Item>
  void read_apart(Sensor<Item>* sensor, const Role& role) {
    if (sensor->own) return;
    sensor->own = open_messages(path_);
    Message message;
    for (std::size_t met = 0; met < sensor->met && sensor->own->next(&message);) {
      met += role.fits(sensor->own->topics()[message.topic]) ? 1U : 0U;
    }
  }

  fs::path path_;
  RecordingRequest request_;
  Surveyed survey_;
  std::unique_ptr<MessageStream> common_;
  Sensor<ImuSample> imu_;
  Sensor<RadarScan> radar_;
  std::optional<CloudReader> clouds_;
  std::size_t scan_ = 0;  ///< next one of the outline
};

}  // namespace

std::unique_ptr<io::RecordingStream> open_recording(const fs::path& path,
                                                    const RecordingRequest& request) {
  return std::make_unique<BagStream>(path, request);
}

Recording read_recording(const fs::path& path, const RecordingRequest& request) {
  BagStream stream(path, request);
  return {io::collect(&stream), stream.outline().damage};
}

}  // namespace rio::bag
