// SPDX-License-Identifier: BSD-3-Clause
// Clocks that jump, topics that arrive late or are shared, stamps that are corrupt: each recording
// reads as one of a clock that runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "bag/driver_recording.hpp"
#include "rio/bag/summary.hpp"

namespace rio::bag {
namespace {

class RecordingClocks : public DriverRecording {};

/// at_rest() whose clocks jump after half of the messages.
/// @param of "imu", "radar" or both
std::vector<Written> jumping(const std::string& of, Time headers, Time received) {
  std::vector<Written> messages;
  const std::vector<Written> good = test::at_rest(Wire::kRos1, 40);
  for (std::size_t i = 0; i < good.size(); ++i) {
    const bool late = i >= good.size() / 2;
    const bool is_imu = good[i].topic == "/imu";
    const bool jumps = late && (of == "both" || of == (is_imu ? "imu" : "radar"));
    Written m = good[i];
    if (late) m.received += received;
    if (jumps) move_header(&m, headers);
    messages.push_back(m);
  }
  return messages;
}

TEST_F(RecordingClocks, AClockThatJumpsGoesOnAsTheMessagesWereReceived) {
  const io::Dataset good = read(test::at_rest(Wire::kRos1, 40));
  for (const char* of : {"both", "imu", "radar"}) {
    for (const Time jump :
         {-9 * kSecond, 9 * kSecond, -1'599'999'000 * kSecond, -kSecond / 5, -kSecond / 10,
          kSecond / 5, kSecond / 10, 3 * kSecond / 10, 31 * kSecond / 100}) {
      const io::Dataset recording = read(jumping(of, jump, Time(0)));
      expect_same(recording, good);
      expect_told(recording, "the header clock jumps by ");
    }
  }
  // the clock of the recorder with them, by NTP or by hand: the interval at the step is that of the
  // IMU before
  for (const Time step : {-kSecond / 5, -kSecond / 10, -10 * kSecond, 1'599'999'000 * kSecond}) {
    expect_same(read(jumping("both", step, step)), good);
    const std::string text = summary_text(summarise(open_messages(dir_.path() / "a").get()));
    EXPECT_PRED2(test::contains, text, "  100.00 Hz");
  }
}

TEST_F(RecordingClocks, AClockThatIsSetToTheRecordersIsRightFromTheBegin) {
  constexpr Time kBoot = -1'599'999'000 * kSecond;
  const io::Dataset good = read(test::at_rest(Wire::kRos1, 40));
  for (const std::string of : {"both", "imu", "radar"}) {
    std::vector<Written> messages = jumping(of, -kBoot, Time(0));
    for (Written& m : messages) {
      if (of == "both" || m.topic == "/" + of) move_header(&m, kBoot);
    }
    const io::Dataset recording = read(messages);
    expect_same(recording, good);
    expect_told(recording, "the header clock begins as another one");
  }
}

/// Too near for a jump: the check looks.
TEST_F(RecordingClocks, StampsOfTheImuThatGoBackAreOdd) {
  const auto is_odd = [this](Time step) {
    (void)read(jumping("imu", step, Time(0)));
    return open_recording(dir_.path() / "a", {})->outline().imu_odd;
  };
  EXPECT_FALSE(is_odd(Time(0)));
  EXPECT_TRUE(is_odd(-kSecond / 25));
}

TEST_F(RecordingClocks, AHeaderThatIsLeftZeroIsThatOfItsReceiveTime) {
  const io::Dataset good = read(test::at_rest(Wire::kRos1, 40));
  for (std::size_t which : {0U, 100U}) {
    std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
    while (messages[which].topic != "/imu") ++which;
    set_header(&messages[which], Time(0));
    const io::Dataset recording = read(messages);
    expect_same(recording, good);
    expect_told(recording, "stamped by their headers (1 header stamps");
  }
  std::vector<Written> messages = jumping("imu", 9 * kSecond, Time(0));
  std::size_t late = messages.size() - 20;  // behind the jump
  while (messages[late].topic != "/imu") ++late;
  set_header(&messages[late], Time(0));
  expect_same(read(messages), good);
}

TEST_F(RecordingClocks, MessagesThatAreSwappedOrStampedLateAreNoJump) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
  std::vector<std::size_t> scans;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (messages[i].topic == "/radar") scans.push_back(i);
  }
  for (const std::size_t k : {3U, 9U, 20U, 30U}) {  // swapped by a queue, and stamped 80 ms early
    std::swap(messages[scans[k]].data, messages[scans[k + 1]].data);
    std::swap(messages[scans[k]].received, messages[scans[k] + 7].received);
    move_header(&messages[scans[k + 4]], -kSecond / 12);
    move_header(&messages[scans[k] + 3], -kSecond / 12);
  }
  expect_not_told(read(messages), "jumps");
}

/// Late by up to 200 ms at random, and every fifth lost: headers are often ahead of their messages.
TEST_F(RecordingClocks, MessagesThatAreLateAndLostAreNoJump) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 400);
  std::mt19937 random(7);
  for (Written& m : messages) {
    if (m.topic == "/radar") m.received += Time(static_cast<int>(random() % 200) * 1'000'000);
  }
  std::erase_if(messages,
                [&](const Written& m) { return m.topic == "/radar" && random() % 5 == 0; });
  expect_not_told(read(messages), "jumps");
}

/// Half of the messages late at random, by many intervals; or blocks of the file exchanged.
TEST_F(RecordingClocks, MessagesThatComeLateAreThoseOfTheirStamps) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 160);
  const io::Dataset good = read(messages);
  std::vector<Written> blocks = messages;
  for (std::size_t i = 110; i < 550; i += 220) {
    const auto begin = blocks.begin() + static_cast<std::ptrdiff_t>(i);
    std::swap_ranges(begin, begin + 110, begin + 110);
  }
  std::mt19937 random(7);
  for (std::size_t i = 11; i < messages.size(); ++i) {
    if (random() % 2 == 0) messages[i].received += Time(random() % 600 * 1'000'000);
  }
  std::ranges::stable_sort(messages, {}, &Written::received);
  for (const std::vector<Written>& of : {messages, blocks}) {
    const io::Dataset recording = read(of);
    expect_same(recording, good);
    for (std::size_t i = 0; i < good.imu.size(); ++i) {
      EXPECT_EQ(recording.imu[i].gyro_B, good.imu[i].gyro_B);
    }
    for (std::size_t i = 0; i < good.scans.size(); ++i) {
      EXPECT_EQ(recording.scans[i].detections[1].range_rate,
                good.scans[i].detections[1].range_rate);
    }
    expect_told(recording, "in the order of these: ");
    expect_not_told(recording, "jumps");
    expect_not_told(recording, "paused");
    EXPECT_FALSE(open_recording(dir_.path() / "a", {})->outline().imu_odd);
  }
}

TEST_F(RecordingClocks, TwoImusOnOneTopicAreToldApartByTheirFrames) {
  const std::string frame = "imu_link";
  const auto twice = [&frame](const Written& m, Time, std::vector<Written>* out) {
    out->push_back(m);
    out->push_back(m);
    out->back().received += Time(2'000'000);
    out->back().data.replace(m.data.find(frame), frame.size(), "imu_back");
  };
  std::vector<Written> messages = replaced(Wire::kRos1, 40, "/imu", twice);
  EXPECT_ERROR(read(messages),
               "several topics of type sensor_msgs/Imu; choose with --imu (TOPIC@FRAME: those of "
               "its messages with that frame_id):");
  for (const char* topic : {"/imu", "/imu@imu_back"}) {
    RecordingRequest request;
    request.imu_topic = topic;
    expect_same(read(messages, request), read(test::at_rest(Wire::kRos1, 40)));
  }
  // one that changes its frame once, or with each message, is one
  for (const std::size_t step : {std::size_t{200}, std::size_t{1}}) {
    messages = test::at_rest(Wire::kRos1, 40);
    for (std::size_t i = step; i < messages.size(); ++i) {
      const std::size_t at = messages[i].data.find(frame);
      const std::string other = "imu_" + std::to_string(1000 + i / step);
      if (at != std::string::npos) messages[i].data.replace(at, frame.size(), other);
    }
    expect_same(read(messages), read(test::at_rest(Wire::kRos1, 40)));
  }
}

TEST_F(RecordingClocks, AClockSetForwardOrAPauseIsTold) {
  expect_told(read(jumping("both", 5 * kSecond, 5 * kSecond)),
              "clock set forward by 5.0 s, or the recorder paused, 2.0 s after the begin: the "
              "flight behind needs a recording of its own");
  std::vector<Written> both = jumping("both", 3600 * kSecond, Time(0));  // the clock, in a pause
  for (const char* topic : {"/imu", "/radar"}) {
    both = without(both, topic, kSecond, 5 * kSecond / 2);
  }
  expect_told(read(both),
              "clock set forward by 1.5 s, or the recorder paused, 1.0 s after the begin");
  const std::vector<Written> good = test::at_rest(Wire::kRos1, 40);
  expect_not_told(read(without(good, "/imu", kSecond, 2 * kSecond)), "set forward");
}

/// at_rest() of 16 s; the messages of a topic are late by what `late` says of the time so far.
std::vector<Written> arriving(const std::string& topic, const std::function<Time(Time)>& late) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 160);
  const Time begin = messages[0].received;
  for (Written& m : messages) {
    if (m.topic == topic || topic.empty()) m.received += late(m.received - begin);
  }
  return messages;
}

TEST_F(RecordingClocks, ATopicThatArrivesLateIsOnItsClock) {
  const io::Dataset good = read(test::at_rest(Wire::kRos1, 160));
  const auto growing = [](Time at) { return at / 5; };
  const auto drained = [](Time at) { return at < 9 * kSecond ? 3 * kSecond / 2 : Time(0); };
  const auto slow = [](Time at) { return 9 * at; };
  for (const std::string topic : {"/radar", "/imu"}) {
    expect_same(read(arriving(topic, growing)), good);
    expect_same(read(arriving(topic, drained)), good);
  }
  // at a tenth of the speed, recorded again, with a radar that begins later
  const std::vector<Written> played = without(arriving("", slow), "/radar", Time(0), 7 * kSecond);
  EXPECT_EQ(read(played).scans[0].time, good.scans[7].time);

  std::vector<Written> apart = test::at_rest(Wire::kRos1, 40);
  for (Written& m : apart) {
    if (m.topic == "/radar") move_header(&m, -5 * kSecond);
  }
  expect_told(read(apart),
              "5.000 s apart; if one only arrives late: --imu-clock header --radar-clock header");
}

/// A driver that stamps by whole seconds or by 0.15 s, or all scans by its own start.
TEST_F(RecordingClocks, HeadersThatAreThoseOfTheMessageBeforeAreNoTimes) {
  RecordingRequest received;
  received.radar_clock = Clock::kReceive;
  const io::Dataset good = read(test::at_rest(Wire::kRos1, 40), received);
  for (const Time step : {kSecond, Time(150'000'000), 1000 * kSecond}) {
    std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
    for (Written& m : messages) {
      if (m.topic == "/radar") set_header(&m, m.received / step * step);
    }
    const io::Dataset recording = read(messages);
    expect_same(recording, good);
    expect_told(recording, " header stamps are those of the message");
    RecordingRequest headers;
    headers.radar_clock = Clock::kHeader;
    EXPECT_LT(read(messages, headers).scans.size(), step < kSecond ? 28U : 6U);
  }
}

TEST_F(RecordingClocks, ScansThatAreThereTwiceHaveTimes) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
  const io::Dataset good = read(messages);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (messages[i].topic != "/radar") continue;
    messages.insert(messages.begin() + static_cast<std::ptrdiff_t>(i) + 1, messages[i]);
    messages[++i].received += Time(300'000);
  }
  expect_same(read(messages), good);
}

TEST_F(RecordingClocks, OneCorruptStampIsNoJump) {
  for (const std::size_t place : {std::size_t{0}, std::size_t{57}}) {
    std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
    messages[place].data[5] = static_cast<char>(messages[place].data[5] ^ 0x10);
    const io::Dataset good = read(test::at_rest(Wire::kRos1, 40));
    const io::Dataset recording = read(messages);
    expect_not_told(recording, "jumps");
    EXPECT_NE(recording.imu[place - place / 11].time, good.imu[place - place / 11].time);
    EXPECT_EQ(recording.imu.back().time, good.imu.back().time);
  }
}

}  // namespace
}  // namespace rio::bag
