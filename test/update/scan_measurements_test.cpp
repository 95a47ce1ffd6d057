// SPDX-License-Identifier: BSD-3-Clause
// The measurements of a scan as both back-ends use them.
#include "rio/update/scan_measurements.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace rio {
namespace {

Measured<LandmarkPointModel> point_of(std::size_t landmark) {
  Measured<LandmarkPointModel> m;
  m.landmark = landmark;
  return m;
}

class ScanMeasurementsTest : public testing::Test {
 protected:
  /// A Doppler, points of the landmarks 0 to 3, a distance to landmark 3, a trail distance.
  ScanMeasurementsTest() {
    all_.add(Measured<DopplerModel>{});
    for (std::size_t i = 0; i < 4; ++i) all_.add(point_of(i));
    all_.add(Measured<LandmarkDistanceModel>{{}, 0, 3});
    all_.add(Measured<TrailDistanceModel>{});
  }
  std::vector<std::size_t> landmarks() const {
    std::vector<std::size_t> out;
    for (const auto& m : all_.of<LandmarkPointModel>()) out.push_back(m.landmark);
    return out;
  }

  ScanMeasurements all_;
};

TEST_F(ScanMeasurementsTest, AreKeptByModel) {
  EXPECT_EQ(all_.size(), 7U);
  EXPECT_EQ(all_.sizes(), (ScanMeasurements::Sizes{1, 4, 1, 0, 1, 0}));
  std::size_t seen = 0;
  all_.for_each([&seen](const auto&) { ++seen; });
  EXPECT_EQ(seen, 7U);
  all_.clear();
  EXPECT_EQ(all_.size(), 0U);
}

TEST_F(ScanMeasurementsTest, CutRemovesWhatWasAppended) {
  const ScanMeasurements::Sizes before = all_.sizes();
  ScanMeasurements more;
  more.add(Measured<RestModel>{});
  more.add(point_of(9));
  all_.append(more);
  EXPECT_EQ(all_.size(), 9U);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 1, 2, 3, 9}));
  all_.cut(before);
  EXPECT_EQ(all_.sizes(), before);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST_F(ScanMeasurementsTest, TheLastLandmarkTakesThePlaceOfTheForgottenOne) {
  all_.forget_landmark(1, 3);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 2, 1}));
  EXPECT_EQ(all_.of<LandmarkDistanceModel>()[0].landmark, 1U);
  all_.forget_landmark(2, 2);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(all_.of<DopplerModel>().size(), 1U);
  EXPECT_EQ(all_.of<TrailDistanceModel>().size(), 1U);
}

// A point and its Doppler are two models of one measurement.
TEST_F(ScanMeasurementsTest, EveryModelOfAMeasurementIsCalledUntilOneIsOutOfItsDomain) {
  const RadarModels models{UpdateOptions{}};
  const auto calls = [&models](const auto& m, int valid) {
    int count = 0;
    const bool all = models.for_each_model(m, [&](const auto&, const auto&) {
      ++count;
      return count <= valid;
    });
    return std::pair{count, all};
  };
  Measured<LandmarkPointModel> m;
  EXPECT_EQ(calls(m, 9), (std::pair{1, true}));
  m.doppler = LandmarkDopplerModel::Measurement{};
  EXPECT_EQ(calls(m, 9), (std::pair{2, true}));
  EXPECT_EQ(calls(m, 1), (std::pair{2, false}));
  EXPECT_EQ(calls(m, 0), (std::pair{1, false}));
  EXPECT_EQ(calls(Measured<DopplerModel>{}, 9), (std::pair{1, true}));
}

}  // namespace
}  // namespace rio
