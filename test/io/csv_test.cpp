// SPDX-License-Identifier: BSD-3-Clause
// Tables of text, and quantities with their units.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "rio/io/csv.hpp"
#include "rio/io/units.hpp"
#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(Units, PlainNumbersAreSi) {
  EXPECT_EQ(parse_quantity("4e-4", "rad/s/sqrt(Hz)"), 4e-4);
  EXPECT_EQ(parse_quantity(" -2.5 ", "m"), -2.5);
  EXPECT_EQ(parse_quantity("+3", ""), 3.0);
}

TEST(Units, Converts) {
  // one rounding per factor: relative 1e-15
  const auto expect = [](const char* text, const char* unit, double si) {
    EXPECT_NEAR(parse_quantity(text, unit), si, 1e-15 * std::abs(si)) << text;
  };
  expect("2 deg", "rad", 2.0 * kPi / 180.0);
  expect("30ms", "s", 0.03);
  expect("5 cm", "m", 0.05);
  expect("10 deg/s", "rad/s", 10.0 * kPi / 180.0);
  expect("10 mdeg/s", "rad/s", 0.01 * kPi / 180.0);
  expect("30 rpm", "rad/s", kPi);
  expect("36 km/h", "m/s", 10.0);
  expect("40 %", "", 0.4);
  expect("100 ug/sqrt(Hz)", "m/s^2/sqrt(Hz)", 100e-6 * 9.80665);
  expect("0.6 deg/sqrt(h)", "rad/s/sqrt(Hz)", 0.6 * kPi / 180.0 / 60.0);
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

using test::TempDir;

TEST(Csv, ReadsRowsAndSkipsCommentsAndBlankLines) {
  const TempDir dir;
  CsvReader rows(dir.write("a.csv", "#t,x\n\n1403636579758555392, 1.5\n# note\n-2,-1e-3\n"));
  ASSERT_TRUE(rows.next());
  EXPECT_EQ(rows.columns(), 2U);
  EXPECT_EQ(rows.integer(0), 1403636579758555392);  // a double would round this
  EXPECT_EQ(rows.number(1), 1.5);
  ASSERT_TRUE(rows.next());
  EXPECT_EQ(rows.integer(0), -2);
  EXPECT_EQ(rows.number(1), -1e-3);
  EXPECT_FALSE(rows.next());
}

TEST(Csv, ToleratesOtherEndsOfLinesQuotesAndAByteOrderMark) {
  const TempDir dir;
  for (const char* text :
       {"\xEF\xBB\xBF#t,x\r\n1,2\r\n3,4", "#t,x\r1,2\r3,4\r", "#t,x\r\r\n1,2\r\r\n3,4\r\r\n",
        "\"#t\",\"x\"\n\"1\",\"2\"\n\"3\", \"4\" \n", "\"t,x\"\n\"1,2\"\n\"3,4\"\n",
        "'t','x'\n'1','2'\n'3','4'\n"}) {
    CsvReader rows(dir.write("a.csv", text));
    ASSERT_TRUE(rows.next()) << text;
    EXPECT_EQ(rows.integer(0), 1) << text;
    EXPECT_EQ(rows.number(1), 2.0) << text;
    ASSERT_TRUE(rows.next()) << text;
    EXPECT_EQ(rows.number(1), 4.0) << text;
    EXPECT_FALSE(rows.next()) << text;
  }
}

/// The file is read in pieces: rows of all lengths lie across their borders.
TEST(Csv, ReadsRowsOfAnyLengthFromALongFile) {
  const TempDir dir;
  std::string text;
  const auto padding = [](int row) {
    return std::string(static_cast<std::size_t>(row) * 7 % 90, ' ');
  };
  for (int row = 0; row < 9000; ++row) {
    text += std::to_string(row) + "," + padding(row) + std::to_string(0.5 * row);
    text += row < 4500 ? "\r\n" : "\r";
  }
  text += "#" + std::string(200'000, 'x') + "\n9000," + std::string(200'000, ' ') + "4500";
  CsvReader rows(dir.write("a.csv", text));
  for (int row = 0; row <= 9000; ++row) {
    ASSERT_TRUE(rows.next());
    ASSERT_EQ(rows.integer(0), row);
    ASSERT_EQ(rows.number(1), 0.5 * row);
  }
  EXPECT_NE(rows.place().find("a.csv:9002"), std::string::npos);
  EXPECT_FALSE(rows.next());
  EXPECT_FALSE(rows.next());
}

TEST(Csv, AcceptsNonFiniteNumbersAndPlusSigns) {
  const TempDir dir;
  CsvReader rows(dir.write("a.csv", "nan,-inf,+2.5\n"));
  ASSERT_TRUE(rows.next());
  EXPECT_TRUE(std::isnan(rows.number(0)));
  EXPECT_EQ(rows.number(1), -INFINITY);
  EXPECT_EQ(rows.number(2), 2.5);
}

TEST(Csv, TruncatedRowNamesFileAndLine) {
  const TempDir dir;
  CsvReader rows(dir.write("a.csv", "#t,x,y\n1,2,3\n4,5"));
  ASSERT_TRUE(rows.next());
  EXPECT_ERROR(rows.next(), "a.csv:3: has 2 columns, the rows before have 3");
}

TEST(Csv, ALastLineThatIsCutEndsATableThatMayBeCut) {
  const TempDir dir;
  for (const char* last : {"4,5", "4,5,", "4,5,-", "4,5,1e", "4", "4,5\n", "4,5,\n\n"}) {
    CsvReader rows(dir.write("a.csv", std::string("#t,x,y\n1,2,3\n") + last), ',', true);
    EXPECT_TRUE(rows.next());
    EXPECT_FALSE(rows.next()) << last;
    EXPECT_PRED2(test::contains, rows.cut(), "a.csv:3: the file ends inside of this line");
  }
  for (const char* last : {"4,5,6", "4,5,6\n", "4,,", "4,,\n"}) {  // an empty scan
    CsvReader whole(dir.write("a.csv", std::string("1,2,3\n") + last), ',', true);
    EXPECT_TRUE(whole.next() && whole.next() && !whole.next()) << last;
    EXPECT_EQ(whole.cut(), "");
  }
  CsvReader inside(dir.write("a.csv", "1,2,3\n4,5\n7,8,9\n"), ',', true);
  EXPECT_TRUE(inside.next());
  EXPECT_ERROR(inside.next(), "a.csv:2: has 2 columns, the rows before have 3");
}

TEST(Csv, ZerosOfAPowerFailureEndATableThatMayBeCut) {
  const TempDir dir;
  const auto file = dir.write("a.csv", "1,2,3\n4," + std::string(5000, '\0') + "\n7,8,9\n");
  CsvReader rows(file, ',', true);
  EXPECT_TRUE(rows.next());
  EXPECT_FALSE(rows.next());
  EXPECT_PRED2(test::contains, rows.cut(), "a.csv:2: the file holds bytes of zero here");
  CsvReader whole(file);
  EXPECT_TRUE(whole.next());
  EXPECT_ERROR(whole.next(), "a.csv:2: holds bytes of zero: damaged");
  CsvReader wide(dir.write("a.csv", std::string("#\0t\0\n\0001\0,\0002\0\n\0", 14)), ',', true);
  EXPECT_ERROR(wide.next(), "a.csv:2: holds bytes of zero: damaged, or UTF-16");
}

TEST(Csv, AnotherFileIsNamed) {
  const TempDir dir;
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
    EXPECT_ERROR(CsvReader(dir.write("a.csv", other.text)), other.what);
  }
}

TEST(Csv, AColumnThatCountsTheRowsIsNamed) {
  const TempDir dir;
  for (const char* heading : {",t,x", "\"\",\"t\",\"x\"", ",#t [ns],x"}) {
    CsvReader rows(dir.write("a.csv", std::string(heading) + "\n0,1,2.5\n"));
    EXPECT_ERROR(rows.next(), "a.csv:1: the first column counts the rows");
  }
}

TEST(Csv, AHeadingNeedsNoHash) {
  const TempDir dir;
  for (const char* heading : {"timestamp [ns],x", "\"t\",\"x\"", "Time,x\nns,m"}) {
    CsvReader rows(dir.write("a.csv", std::string(heading) + "\n1,2.5\n"));
    ASSERT_TRUE(rows.next()) << heading;
    EXPECT_EQ(rows.integer(0), 1);
    EXPECT_FALSE(rows.next());
  }
  CsvReader joined(dir.write("a.csv", "t,x\n1,2.5\nt,x\n2,2.5\n"));
  ASSERT_TRUE(joined.next() && joined.next());
  EXPECT_EQ(joined.integer(0), 2);
  CsvReader later(dir.write("a.csv", "1,2.5\nt,x\n"));
  ASSERT_TRUE(later.next() && later.next());
  EXPECT_ERROR(later.integer(0), "a.csv:2: column 1: not an integer");
}

TEST(Csv, NamesAtAnotherPlaceAreAnError) {
  const auto read = [](const std::string& heading) {
    const TempDir dir;
    CsvReader rows(dir.write("a.csv", heading + "\n1,2,3,4\n"));
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
  EXPECT_ERROR(read("timestamp,x,qw,y"), "column 3 is \"qw\"");
}

TEST(Csv, RejectsWhatIsNotANumber) {
  const TempDir dir;
  CsvReader rows(dir.write("a.csv", "1x,1.5,,+-1,0x1F,99999999999999999999,1 2\n"));
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

TEST(Csv, DecimalCommasAndOtherSeparatorsAreNamed) {
  const TempDir dir;
  CsvReader commas(dir.write("a.csv", "#t,x,y\n1,-0,5,0,25\n"));
  EXPECT_ERROR(commas.next(),
               "a.csv:2: has 5 columns, the header has 3: numbers need a decimal point");
  CsvReader more(dir.write("b.csv", "#t,x,y\n1,-0.5,0.25,3,4\n"));
  EXPECT_TRUE(more.next());
  CsvReader semicolons(dir.write("c.csv", "#t;x\n1;2.5\n"));
  ASSERT_TRUE(semicolons.next());
  EXPECT_ERROR(semicolons.integer(0),
               "column 1: not an integer: \"1;2.5\"; columns are separated by commas, not by ;");
  CsvReader dates(dir.write("d.csv", "2023-11-14 22:13:22.5,1\n"));
  ASSERT_TRUE(dates.next());
  EXPECT_ERROR(dates.integer(0), "22.5\"; a date: a stamp is a number of nanoseconds");
  CsvReader names(dir.write("e.csv", "1,2\nt [ns],x\n"));
  ASSERT_TRUE(names.next() && names.next());
  EXPECT_EQ(test::error_of([&] { (void)names.integer(0); }).find("separated"), std::string::npos);
}

TEST(Csv, SecondsAreExactToTheNanosecond) {
  const TempDir dir;
  CsvReader rows(dir.write("a.tum",
                           "1403715273.262142976 1.5 -0.000000001 7 1.403715273262142976e+09 "
                           "0.0000000015 2.5E-9 1e3 -1.9999999996\n"
                           "1.2.3 e9 - . 1e12 99999999999 abc 1e 1ee2\n"),
                 ' ');
  ASSERT_TRUE(rows.next());
  const std::int64_t expected[] = {1403715273262142976, 1500000000, -1, 7000000000,
                                   1403715273262142976, 2,          3,  1000000000000,
                                   -2000000000};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(rows.seconds_to_ns(i), expected[i]) << i;
  ASSERT_TRUE(rows.next());
  for (std::size_t i = 0; i < 9; ++i) EXPECT_ERROR(rows.seconds_to_ns(i), "a.tum:2: column") << i;
}

TEST(Csv, SpacesSeparateInRuns) {
  const TempDir dir;
  CsvReader rows(dir.write("a.tum", "  1  2\t3 \n"), ' ');
  ASSERT_TRUE(rows.next());
  EXPECT_EQ(rows.columns(), 3U);
  EXPECT_EQ(rows.number(2), 3.0);
}

TEST(Csv, MissingEmptyAndFolder) {
  const TempDir dir;
  EXPECT_ERROR(CsvReader(dir.path() / "none.csv"), "none.csv: no such file");
  EXPECT_ERROR(CsvReader(dir.write("empty.csv", "")), "empty.csv: is empty");
  EXPECT_ERROR(CsvReader(dir.path()), "is a folder");
  EXPECT_ERROR(CsvReader(dir.write("wide.csv", std::string("\xFF\xFE#\0", 4))), "is UTF-16");
}

}  // namespace
}  // namespace rio::io
