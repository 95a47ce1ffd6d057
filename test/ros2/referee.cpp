// SPDX-License-Identifier: BSD-3-Clause
// The other side of rio-ros2, with the DDS of another vendor, which is ROS 2's own default: plays a
// dataset folder as sensor topics and prints what comes back, one line per message.
//
//   referee play FLIGHT SPEED [RadarScan]
//                                 publishes the sensors of the folder, prints /rio/pose and more; a
//                                 pressure of zero stands for a message on /rio/reset. Points are
//                                 PointCloud2, or radar_msgs/RadarScan
//   referee listen SECONDS        prints, until SIGTERM or that long
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "feeds.hpp"
#include "messagesPubSubTypes.h"

namespace {

namespace dds = eprosima::fastdds::dds;
using Duration = std::chrono::duration<double>;

/// As rmw_fastrtps sets it: messages of any size.
template <class Qos>
Qos qos_of(Qos qos, int depth, bool reliable) {
  qos.history().depth = depth;
  qos.reliability().kind =
      reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  return qos;
}

class Node {
 public:
  Node() {
    const char* domain = std::getenv("ROS_DOMAIN_ID");
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
        domain == nullptr ? 0U : static_cast<unsigned>(std::atoi(domain)),
        dds::PARTICIPANT_QOS_DEFAULT);
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }

  template <class Type>
  dds::DataWriter* writer(const char* name) {
    return publisher_->create_datawriter(topic<Type>(name),
                                         qos_of(dds::DATAWRITER_QOS_DEFAULT, 2000, true));
  }
  template <class Type>
  dds::DataReader* reader(const char* name) {
    return subscriber_->create_datareader(topic<Type>(name),
                                          qos_of(dds::DATAREADER_QOS_DEFAULT, 500, true));
  }

 private:
  template <class Type>
  dds::Topic* topic(const char* name) {
    const dds::TypeSupport type(new Type);
    type.register_type(participant_);
    return participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  }

  dds::DomainParticipant* participant_;
  dds::Publisher* publisher_;
  dds::Subscriber* subscriber_;
};

template <class Header>
long long nanoseconds(const Header& header) {
  return 1'000'000'000LL * header.stamp().sec() + header.stamp().nanosec();
}

/// The outputs of rio-ros2.
class Listener {
 public:
  explicit Listener(Node* node)
      : odometry_(node->reader<nav_msgs::msg::dds_::Odometry_PubSubType>("rt/rio/odometry")),
        pose_(node->reader<geometry_msgs::msg::dds_::PoseWithCovarianceStamped_PubSubType>(
            "rt/rio/pose")),
        transforms_(node->reader<tf2_msgs::msg::dds_::TFMessage_PubSubType>("rt/tf")),
        points_(node->reader<sensor_msgs::msg::dds_::PointCloud2_PubSubType>("rt/rio/points")),
        diagnostics_(node->reader<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
            "rt/diagnostics")) {}

  bool matched() const {
    dds::SubscriptionMatchedStatus status;
    pose_->get_subscription_matched_status(status);
    return status.current_count > 0;
  }

  /// Whether there was a pose.
  bool print() {
    bool any = false;
    dds::SampleInfo info;
    nav_msgs::msg::dds_::Odometry_ odometry;
    while (take(odometry_, &odometry, &info)) {
      const auto& p = odometry.pose().pose().position();
      const auto& v = odometry.twist().twist().linear();
      std::printf("odometry %lld %s %s %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n",
                  nanoseconds(odometry.header()), odometry.header().frame_id().c_str(),
                  odometry.child_frame_id().c_str(), p.x(), p.y(), p.z(), v.x(), v.y(), v.z(),
                  odometry.pose().covariance()[0], odometry.twist().covariance()[0]);
    }
    geometry_msgs::msg::dds_::PoseWithCovarianceStamped_ pose;
    while (take(pose_, &pose, &info)) {
      const auto& p = pose.pose().pose().position();
      const auto& q = pose.pose().pose().orientation();
      any = true;
      std::printf("pose %lld %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n",
                  nanoseconds(pose.header()), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(),
                  pose.pose().covariance()[0]);
    }
    tf2_msgs::msg::dds_::TFMessage_ transforms;
    while (take(transforms_, &transforms, &info)) {
      const auto& t = transforms.transforms().at(0);
      std::printf("tf %lld %s %s %.17g\n", nanoseconds(t.header()), t.header().frame_id().c_str(),
                  t.child_frame_id().c_str(), t.transform().translation().x());
    }
    PointCloud2_ cloud;
    while (take(points_, &cloud, &info)) print_points(cloud);
    diagnostic_msgs::msg::dds_::DiagnosticArray_ diagnostics;
    while (take(diagnostics_, &diagnostics, &info)) {
      const auto& status = diagnostics.status().at(0);
      std::printf("diagnostics %d %s %zu\n", status.level(), status.message().c_str(),
                  status.values().size());
    }
    std::fflush(stdout);
    return any;
  }

 private:
  template <class Message>
  static bool take(dds::DataReader* reader, Message* message, dds::SampleInfo* info) {
    while (reader->take_next_sample(message, info) == ReturnCode_t::RETCODE_OK) {
      if (info->valid_data) return true;
    }
    return false;
  }

  /// Points of each label.
  static void print_points(const PointCloud2_& cloud) {
    unsigned labels[3] = {0, 0, 0};
    std::uint32_t offset = 0;
    for (const PointField_& field : cloud.fields()) {
      if (field.name() == "label") offset = field.offset();
    }
    for (std::uint32_t i = 0; i < cloud.width(); ++i) {
      std::uint32_t label = 9;
      std::memcpy(&label, cloud.data().data() + i * cloud.point_step() + offset, sizeof label);
      ++labels[label];
    }
    std::printf("points %lld %s %u %u %u\n", nanoseconds(cloud.header()),
                cloud.header().frame_id().c_str(), labels[0], labels[1], labels[2]);
  }

  dds::DataReader* odometry_;
  dds::DataReader* pose_;
  dds::DataReader* transforms_;
  dds::DataReader* points_;
  dds::DataReader* diagnostics_;
};

/// The points of the folder, by `message_of` of some rows.
template <class PubSubType, class MessageOf>
Feed radar_feed(const std::string& folder, const std::string& topic, Node* node,
                MessageOf message_of, std::vector<dds::DataWriter*>* writers) {
  dds::DataWriter* writer = node->writer<PubSubType>(topic.c_str());
  writers->push_back(writer);
  return {rows_of(folder + "/data.csv"), [=](const auto& rows, auto from, auto to) {
            auto message = message_of(rows, from, to);
            writer->write(&message);
          }};
}

Feed pressure_feed(const std::string& folder, Node* node) {
  dds::DataWriter* pressures =
      node->writer<sensor_msgs::msg::dds_::FluidPressure_PubSubType>("rt/pressure");
  dds::DataWriter* resets = node->writer<std_msgs::msg::dds_::Empty_PubSubType>("rt/rio/reset");
  return {rows_of(folder + "/data.csv"), [=](const auto& rows, auto from, auto) {
            std_msgs::msg::dds_::Empty_ reset;
            FluidPressure_ message;
            stamp(&message, rows[from].time, "baro");
            message.fluid_pressure(rows[from].values[0]);
            const bool is_pressure = message.fluid_pressure() > 0.0;
            is_pressure ? pressures->write(&message) : resets->write(&reset);
          }};
}

int play(const std::string& flight, double speed, bool radar_scans) {
  const std::vector<Row> imu = rows_of(flight + "/imu0/data.csv");
  Node node;
  dds::DataWriter* imu_writer = node.writer<sensor_msgs::msg::dds_::Imu_PubSubType>("rt/imu/data");
  std::vector<dds::DataWriter*> writers = {imu_writer};
  std::vector<Feed> feeds;
  for (const char* radar : {"/radar0", "/radar1"}) {
    if (!std::filesystem::exists(flight + radar)) continue;
    const std::string topic = std::string("rt") + radar + "/points";
    feeds.push_back(radar_scans ? radar_feed<radar_msgs::msg::dds_::RadarScan_PubSubType>(
                                      flight + radar, topic, &node, radar_scan_of, &writers)
                                : radar_feed<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(
                                      flight + radar, topic, &node, cloud_of, &writers));
  }
  if (std::filesystem::exists(flight + "/baro0")) {
    feeds.push_back(pressure_feed(flight + "/baro0", &node));
  }
  Listener listener(&node);
  const auto matched = [](dds::DataWriter* writer) {
    dds::PublicationMatchedStatus status;
    writer->get_publication_matched_status(status);
    return status.current_count > 0;
  };
  for (int i = 0; !(std::all_of(writers.begin(), writers.end(), matched) && listener.matched());
       ++i) {
    if (i > 200) throw std::runtime_error("rio-ros2 was not found within 20 s");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // the other topics
  const auto begin = std::chrono::steady_clock::now();
  for (const Row& row : imu) {
    std::this_thread::sleep_until(
        begin + Duration(1e-9 * static_cast<double>(row.time - imu[0].time) / speed));
    for (Feed& feed : feeds) feed.publish_until(row.time);
    Imu_ message = imu_of(row);
    imu_writer->write(&message);
    (void)listener.print();
  }
  for (int quiet = 0; quiet < 20; ++quiet) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (listener.print()) quiet = 0;
  }
  return 0;
}

int listen(double seconds) {
  Node node;
  Listener listener(&node);
  const auto end = std::chrono::steady_clock::now() + Duration(seconds);
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    (void)listener.print();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string what = argc > 1 ? argv[1] : "";
    int status = 2;
    if (what == "play" && (argc == 4 || argc == 5)) {
      const std::string type = argc == 5 ? argv[4] : "PointCloud2";
      status = play(argv[2], std::stod(argv[3]), type == "RadarScan");
    }
    if (what == "listen" && argc == 3) status = listen(std::stod(argv[2]));
    std::fflush(stdout);
    std::_Exit(status);  // without the threads of DDS
  } catch (const std::exception& error) {
    std::fprintf(stderr, "referee: %s\n", error.what());
    return 1;
  }
}
