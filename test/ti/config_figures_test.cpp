// SPDX-License-Identifier: BSD-3-Clause
// Figures of a configuration against arithmetic by hand.
#include <gtest/gtest.h>

#include "rio/ti/config.hpp"
#include "support/measured.hpp"
#include "ti/config_text.hpp"

namespace rio::ti::test {
namespace {

TEST(TiConfigFigures, FiguresOfTheCommittedOne) {
  const ConfigFigures f = figures_of(committed());
  // sampled from 7 to 47 us of 23.4 MHz/us from 77 GHz on; a loop takes 3 (10 + 50) us
  const double wavelength = 299792458.0 / (77e9 + 23.4e12 * 27e-6);
  EXPECT_NEAR(f.max_speed, wavelength / (4 * 180e-6), 1e-9);
  EXPECT_NEAR(f.speed_grid, wavelength / (2 * 180e-6 * 128), 1e-9);
  EXPECT_NEAR(f.range_resolution, 299792458.0 / (2 * 23.4e12 * 40e-6), 1e-9);
  EXPECT_NEAR(f.range_grid, f.range_resolution, 1e-9);
  EXPECT_NEAR(f.max_range, 0.8 * 128 * f.range_resolution, 1e-9);
  EXPECT_EQ(f.chirp_block, std::chrono::microseconds(128 * 180));
  EXPECT_DOUBLE_EQ(f.frame_rate(), 20.0);
  EXPECT_EQ(f.receivers, 4);
  EXPECT_EQ(f.transmitters, 3);
  EXPECT_TRUE(f.side_info);
  EXPECT_EQ(f.cube_bytes, 4U * 128 * 128 * 12 + 2U * 128 * 128);
  // 40 + 8 + 16 N + 8 + 4 N, padded to 32: 916 for 43 points
  EXPECT_EQ(f.packet_bytes(0), 64U);
  EXPECT_EQ(f.packet_bytes(43), 928U);
  EXPECT_NEAR(to_seconds(f.packet_time(43)), 928 * 10 / 921600.0, 1e-9);
  rio::test::measured("unambiguous speed, m/s", f.max_speed, "at least 5");
  rio::test::measured("grid of the speed, m/s", f.speed_grid, "below 0.1");
  EXPECT_GE(f.max_speed, 5.0);
  const std::string with_image = replaced(committed(), "adcCfg 2 1", "adcCfg 2 2");
  EXPECT_NEAR(figures_of(with_image).max_range, 0.5 * f.max_range, 1e-9);
}

/// The set-up of the 2023 paper: 0.039 m, 16.28 m, +-1.51 m/s, 32 bins of 0.094 m/s. A chirp of it
/// from these by hand: Tl = lambda / (4 v), with three transmitters.
TEST(TiConfigFigures, FiguresOfAPublishedSetUp) {
  std::string text = replaced(committed(), "profileCfg 0 77 10 7 50 0 0 23.4 1 128 3200 0 0 30",
                              "profileCfg 0 77 151 7 60 0 0 75 1 512 10240 0 0 30");
  text = replaced(text, "frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 32 0 66.667 1 0");
  const ConfigFigures f = figures_of(text);
  EXPECT_NEAR(f.range_resolution, 0.0400, 0.0005);
  EXPECT_NEAR(f.max_range, 16.37, 0.01);
  EXPECT_NEAR(f.max_speed, 1.50, 0.02);
  EXPECT_NEAR(f.speed_grid, 0.094, 0.001);
}

TEST(TiConfigFigures, TransmittersAtOnceDoNotTakeTurns) {
  const std::string text =
      replaced(committed(), "chirpCfg 0 0 0 0 0 0 0 1", "chirpCfg 0 0 0 0 0 0 0 7");
  EXPECT_EQ(figures_of(replaced(text, "frameCfg 0 2", "frameCfg 0 0")).transmitters, 1);
}

TEST(TiConfigFigures, GridsArePowersOfTwo) {
  std::string text = replaced(committed(), "profileCfg 0 77 10 7 50 0 0 23.4 1 128 3200",
                              "profileCfg 0 77 10 7 50 0 0 23.4 1 100 3200");
  text = replaced(text, "frameCfg 0 2 128", "frameCfg 0 2 96");
  const ConfigFigures f = figures_of(text);
  EXPECT_EQ(f.range_bins, 128);
  EXPECT_EQ(f.doppler_bins, 128);
  EXPECT_NEAR(f.range_grid / f.range_resolution, 100.0 / 128, 1e-12);
  EXPECT_NEAR(f.speed_grid, f.max_speed / 64, 1e-12);
}

TEST(TiConfigFigures, TheProfileIsThatOfTheChirps) {
  std::string text = replaced(committed(), "profileCfg",
                              "profileCfg 7 77 10 7 50 0 0 23.4 1 64 3200 0 0 30\n"
                              "profileCfg");
  EXPECT_EQ(figures_of(text).samples, 128);
  for (const char* chirp : {"0 0", "1 1", "2 2"}) {
    const std::string command = std::string("chirpCfg ") + chirp;
    text = replaced(text, command + " 0", command + " 7");
  }
  EXPECT_EQ(figures_of(text).samples, 64);
}

}  // namespace
}  // namespace rio::ti::test
