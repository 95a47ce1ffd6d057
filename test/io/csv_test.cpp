// SPDX-License-Identifier: BSD-3-Clause
// Tables of text, and quantities with their units.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "rio/io/csv.hpp"
#include "rio/io/units.hpp"
#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

TEST(Units, PlainNumbersAreSi) {
  EXPECT_EQ(parse_quantity("4e-4", "rad/s/sqrt(Hz)"), 4e-4);
  EXPECT_EQ(parse_quantity(" -2.5 ", "m"), -2.5);
  EXPECT_EQ(parse_quantity("+3", ""), 3.0);
}

TEST(Units, FactorsMayBeNegative) {
  EXPECT_EQ(unit_factor("m/s^2", "m/s^2"), 1.0);
  EXPECT_EQ(unit_factor("-g", "m/s^2"), -9.80665);
  EXPECT_THROW((void)unit_factor("-s", "m/s^2"), std::invalid_argument);
}

TEST(Units, Converts) {
  // one rounding per factor: relative 1e-15
  const auto expect = [](const char* text, const char* unit, double si) {
    EXPECT_NEAR(parse_quantity(text, unit), si, 1e-15 * std::abs(si)) << text;
  };
  expect("2 deg", "rad", 2.0 * std::numbers::pi / 180.0);
  expect("30ms", "s", 0.03);
  expect("5 cm", "m", 0.05);
  expect("10 deg/s", "rad/s", 10.0 * std::numbers::pi / 180.0);
  expect("10 mdeg/s", "rad/s", 0.01 * std::numbers::pi / 180.0);
  expect("30 rpm", "rad/s", std::numbers::pi);
  expect("36 km/h", "m/s", 10.0);
  expect("40 %", "", 0.4);
  expect("100 ug/sqrt(Hz)", "m/s^2/sqrt(Hz)", 100e-6 * 9.80665);
  expect("0.6 deg/sqrt(h)", "rad/s/sqrt(Hz)", 0.6 * std::numbers::pi / 180.0 / 60.0);
  expect("2 m*s^-2", "m/s^2", 2.0);
  expect("3 dB", "dB", 3.0);
}

TEST(Units, RejectsTheWrongDimension) {
  EXPECT_ERROR(parse_quantity("2 deg", "m"), "\"2 deg\" does not fit the unit [m]");
  EXPECT_ERROR(parse_quantity("2 deg", "rad/s"), "does not fit");
  EXPECT_ERROR(parse_quantity("2 m", ""), "does not fit the unit [1]");
  EXPECT_ERROR(parse_quantity("2 %", "m"), "does not fit");
  EXPECT_ERROR(parse_quantity("2 m/s^2", "m/s^2/sqrt(Hz)"), "does not fit");
}

TEST(Units, RejectsWhatItDoesNotKnow) {
  EXPECT_ERROR(parse_quantity("2 foot", "m"), "unknown unit \"foot\"");
  EXPECT_ERROR(parse_quantity("2 m^x", "m"), "unknown unit \"m^x\"");
  EXPECT_ERROR(parse_quantity("2 m/", "m"), "unknown unit \"\"");
  EXPECT_ERROR(parse_quantity("deg", "rad"), "not a number");
  EXPECT_ERROR(parse_quantity("", "rad"), "not a number");
}

class Csv : public testing::Test {
 protected:
  CsvReader reader(const std::string& text, char separator = ',', bool may_be_cut = false) {
    return CsvReader(dir_.write("a.csv", text), separator, may_be_cut);
  }

  const test::TempDir dir_;
};

TEST_F(Csv, PassesOverCommentsBlankLinesOtherEndsOfLinesAndQuotes) {
  for (const char* text :
       {"#t,x\n\n1,2\n# note\n3,4\n", "\xEF\xBB\xBF#t,x\r\n1,2\r\n3,4", "#t,x\r1,2\r3,4\r",
        "#t,x\r\r\n1,2\r\r\n3,4\r\r\n", "\"#t\",\"x\"\n\"1\",\"2\"\n\"3\", \"4\" \n",
        "\"t,x\"\n\"1,2\"\n\"3,4\"\n", "'t','x'\n'1','2'\n'3','4'\n"}) {
    CsvReader rows = reader(text);
    ASSERT_TRUE(rows.next()) << text;
    EXPECT_EQ(rows.integer(0), 1) << text;
    EXPECT_EQ(rows.number(1), 2.0) << text;
    ASSERT_TRUE(rows.next()) << text;
    EXPECT_EQ(rows.number(1), 4.0) << text;
    EXPECT_FALSE(rows.next()) << text;
  }
}

/// The file is read in pieces: rows of all lengths lie across their borders.
TEST_F(Csv, ReadsRowsOfAnyLengthFromALongFile) {
  std::string text;
  const auto padding = [](int row) {
    return std::string(static_cast<std::size_t>(row) * 7 % 90, ' ');
  };
  for (int row = 0; row < 9000; ++row) {
    text += std::to_string(row) + "," + padding(row) + std::to_string(0.5 * row);
    text += row < 4500 ? "\r\n" : "\r";
  }
  text += "#" + std::string(200'000, 'x') + "\n9000," + std::string(200'000, ' ') + "4500";
  CsvReader rows = reader(text);
  for (int row = 0; row <= 9000; ++row) {
    ASSERT_TRUE(rows.next());
    ASSERT_EQ(rows.integer(0), row);
    ASSERT_EQ(rows.number(1), 0.5 * row);
  }
  EXPECT_NE(rows.place().find("a.csv:9002"), std::string::npos);
  EXPECT_FALSE(rows.next());
  EXPECT_FALSE(rows.next());
}

TEST_F(Csv, ALastLineThatIsCutEndsATableThatMayBeCut) {
  for (const char* last : {"4,5", "4,5,", "4,5,-", "4,5,1e", "4", "4,5\n", "4,5,\n\n"}) {
    CsvReader rows = reader(std::string("#t,x,y\n1,2,3\n") + last, ',', true);
    EXPECT_TRUE(rows.next());
    EXPECT_FALSE(rows.next()) << last;
    EXPECT_PRED2(test::contains, rows.cut(), "a.csv:3: the file ends inside of this line");
  }
  for (const char* last : {"4,5,6", "4,5,6\n", "4,,", "4,,\n"}) {  // an empty scan
    CsvReader whole = reader(std::string("1,2,3\n") + last, ',', true);
    EXPECT_TRUE(whole.next() && whole.next() && !whole.next()) << last;
    EXPECT_EQ(whole.cut(), "");
  }
  CsvReader inside = reader("1,2,3\n4,5\n7,8,9\n", ',', true);
  EXPECT_TRUE(inside.next());
  EXPECT_ERROR(inside.next(), "a.csv:2: has 2 columns, the rows before have 3");
  CsvReader complete = reader("1,2,3\n4,5");  // as it must be
  EXPECT_TRUE(complete.next());
  EXPECT_ERROR(complete.next(), "a.csv:2: has 2 columns, the rows before have 3");
}

TEST_F(Csv, ZerosOfAPowerFailureEndATableThatMayBeCut) {
  const std::string text = "1,2,3\n4," + std::string(5000, '\0') + "\n7,8,9\n";
  CsvReader rows = reader(text, ',', true);
  EXPECT_TRUE(rows.next());
  EXPECT_FALSE(rows.next());
  EXPECT_PRED2(test::contains, rows.cut(), "a.csv:2: the file holds bytes of zero here");
  CsvReader whole = reader(text);
  EXPECT_TRUE(whole.next());
  EXPECT_ERROR(whole.next(), "a.csv:2: holds bytes of zero: damaged");
  CsvReader wide = reader(std::string("#\0t\0\n\0001\0,\0002\0\n\0", 14), ',', true);
  EXPECT_ERROR(wide.next(), "a.csv:2: holds bytes of zero: damaged, or UTF-16");
}

TEST_F(Csv, AnotherFileIsNamed) {
  struct Other {
    std::string text;
    const char* what;
  };
  const Other table[] = {{"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\n",
                          "a.csv: a pointer of git LFS"},
                         {"\n<!DOCTYPE html><html>", "a.csv: a page of HTML"},
                         {"PK\3\4 and so on", "a.csv: a zip archive"},
                         {"%time,field.header.seq\n", "a.csv: a topic as `rostopic echo -p`"},
                         {std::string(100, '\0'), "a.csv: zeros where it begins"}};
  for (const Other& other : table) {
    EXPECT_ERROR(reader(other.text), other.what);
  }
}

TEST_F(Csv, AColumnThatCountsTheRowsIsNamed) {
  for (const char* heading : {",t,x", "\"\",\"t\",\"x\"", ",#t [ns],x"}) {
    CsvReader rows = reader(std::string(heading) + "\n0,1,2.5\n");
    EXPECT_ERROR(rows.next(), "a.csv:1: the first column counts the rows");
  }
}

TEST_F(Csv, AHeadingNeedsNoHash) {
  for (const char* heading : {"timestamp [ns],x", "\"t\",\"x\"", "Time,x\nns,m"}) {
    CsvReader rows = reader(std::string(heading) + "\n1,2.5\n");
    ASSERT_TRUE(rows.next()) << heading;
    EXPECT_EQ(rows.integer(0), 1);
    EXPECT_FALSE(rows.next());
  }
  CsvReader joined = reader("t,x\n1,2.5\nt,x\n2,2.5\n");
  ASSERT_TRUE(joined.next() && joined.next());
  EXPECT_EQ(joined.integer(0), 2);
  CsvReader later = reader("1,2.5\nt,x\n");
  ASSERT_TRUE(later.next() && later.next());
  EXPECT_ERROR(later.integer(0), "a.csv:2: column 1: not an integer");
}

TEST_F(Csv, NamesAtAnotherPlaceAreAnError) {
  const auto read = [this](const std::string& heading) {
    CsvReader rows = reader(heading + "\n1,2,3,4\n");
    rows.expect_names({"timestamp", "x", "y", "qw"});
    EXPECT_TRUE(rows.next());
  };
  read("#timestamp [ns],x [m],y [m],q_RS_w []");
  read("t,X,\"Y\",");
  read("a,b,c,d");         // names of their own
  read("#timestamp,y,x");  // no heading of this table
  EXPECT_ERROR(read("#timestamp [ns],y [m],x [m],qw"),
               "a.csv:2: by the heading column 2 is \"y [m]\"; the columns are read as timestamp, "
               "x, y, qw");
  EXPECT_ERROR(read("timestamp,range,azimuth,doppler"), "column 2 is \"range\"");
  EXPECT_ERROR(read("t,r,az,doppler"), "column 3 is \"az\"");
  EXPECT_ERROR(read("timestamp,x,qw,y"), "column 3 is \"qw\"");
}

TEST_F(Csv, RejectsWhatIsNotANumber) {
  CsvReader rows = reader("1x,1.5,,+-1,0x1F,99999999999999999999,1 2\n");
  ASSERT_TRUE(rows.next());
  EXPECT_ERROR(rows.number(0), "a.csv:1: column 1: not a number: \"1x\"");
  EXPECT_ERROR(rows.integer(1), "column 2: not an integer, as a stamp in ns is: \"1.5\"");
  EXPECT_ERROR(rows.integer(4), "column 5: not an integer: \"0x1F\"");
  EXPECT_TRUE(rows.is_empty(2));
  EXPECT_ERROR(rows.number(2), "column 3: not a number");
  EXPECT_ERROR(rows.number(3), "column 4");
  EXPECT_ERROR(rows.number(4), "column 5");
  EXPECT_ERROR(rows.integer(5), "column 6");
  EXPECT_ERROR(rows.number(6), "column 7");
  EXPECT_ERROR(rows.cell(7), "column 8 is needed");
}

TEST_F(Csv, DecimalCommasAndOtherSeparatorsAreNamed) {
  CsvReader commas = reader("#t,x,y\n1,-0,5,0,25\n");
  EXPECT_ERROR(commas.next(),
               "a.csv:2: has 5 columns, the header has 3: numbers need a decimal point");
  CsvReader more = reader("#t,x,y\n1,-0.5,0.25,3,4\n");
  EXPECT_TRUE(more.next());
  CsvReader semicolons = reader("#t;x\n1;2.5\n");
  ASSERT_TRUE(semicolons.next());
  EXPECT_ERROR(semicolons.integer(0),
               "column 1: not an integer: \"1;2.5\"; columns are separated by commas, not by ;");
  CsvReader dates = reader("2023-11-14 22:13:22.5,1\n");
  ASSERT_TRUE(dates.next());
  EXPECT_ERROR(dates.integer(0), "22.5\"; a date: a stamp is a number of nanoseconds");
  CsvReader names = reader("1,2\nt [ns],x\n");
  ASSERT_TRUE(names.next() && names.next());
  EXPECT_EQ(test::error_of([&] { (void)names.integer(0); }).find("separated"), std::string::npos);
}

/// The cells of TUM files, between runs of blanks and tabs.
TEST_F(Csv, SecondsAreExactToTheNanosecond) {
  CsvReader rows = reader(
      "  1403715273.262142976  1.5 -0.000000001\t7 1.403715273262142976e+09 "
      "0.0000000015 2.5E-9 1e3 -1.9999999996 \n"
      "1.2.3 e9 - . 1e12 99999999999 abc 1e 1ee2\n",
      ' ');
  ASSERT_TRUE(rows.next());
  EXPECT_EQ(rows.columns(), 9U);
  const std::int64_t expected[] = {1403715273262142976, 1500000000, -1, 7000000000,
                                   1403715273262142976, 2,          3,  1000000000000,
                                   -2000000000};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(rows.seconds_to_ns(i), expected[i]) << i;
  ASSERT_TRUE(rows.next());
  for (std::size_t i = 0; i < 9; ++i) EXPECT_ERROR(rows.seconds_to_ns(i), "a.csv:2: column") << i;
}

TEST_F(Csv, MissingEmptyAndFolder) {
  EXPECT_ERROR(CsvReader(dir_.path() / "none.csv"), "none.csv: no such file");
  EXPECT_ERROR(reader(""), "a.csv: is empty");
  EXPECT_ERROR(CsvReader(dir_.path()), "is a folder");
  EXPECT_ERROR(reader(std::string("\xFF\xFE#\0", 4)), "is UTF-16");
}

}  // namespace
}  // namespace rio::io
