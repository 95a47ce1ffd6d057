// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/csv.hpp"

#include <algorithm>
#include <cctype>

namespace rio::io {

namespace {

using namespace std::string_view_literals;

constexpr auto kBag = "a bag of ROS: rio convert makes a folder of it, which is read"sv;

constexpr struct {
  std::string_view begin;  ///< in small letters
  std::string_view what;
} kKinds[] = {
    {"version https://git-lfs"sv, "a pointer of git LFS, not the file itself: git lfs pull"sv},
    {"<!doctype html"sv, "a page of HTML, sent in place of the file: download it again"sv},
    {"<html"sv, "a page of HTML, sent in place of the file: download it again"sv},
    {"<?xml"sv, "XML, often the error of a server in place of the file: download it again"sv},
    {"{\""sv, "JSON, often the error of a server in place of the file: download it again"sv},
    {"\x1F\x8B"sv, "compressed by gzip: unpack it first"sv},
    {"bzh"sv, "compressed by bzip2: unpack it first"sv},
    {"\xFD\x37zxz"sv, "compressed by xz: unpack it first"sv},
    {"pk\3\4"sv, "a zip archive or a spreadsheet: unpack it, or save it as CSV"sv},
    {"7z\xBC\xAF"sv, "a 7z archive: unpack it first"sv},
    {"rar!"sv, "a rar archive: unpack it first"sv},
    {"#rosbag v2"sv, kBag},
    {"\x89mcap0"sv, kBag},
    {"sqlite format 3"sv, kBag},
    {"#rosbag v1"sv, "a bag older than version 2.0: rosbag fix it first"sv},
    {"#rosrecord v"sv, "a bag older than version 2.0: rosbag fix it first"sv},
    {"\2\1\4\3\6\5\b\7"sv,
     "raw packets of a TI radar, without times: record it with rio live --radar PORT --imu PORT "
     "--record FOLDER"sv},
    {"%time,field"sv,
     "a topic as `rostopic echo -p` prints it, in columns of its own: give the bag itself"sv},
    {"ulog\1"sv, "a log of PX4, which holds no radar points: record with ROS or rio live"sv},
    {"\x89hdf"sv, "HDF5, which is not read: write it as a folder of CSV files"sv},
    {"\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"sv, "zeros where it begins: it never came to the disk"sv},
};

/// Whatever the letters' case.
bool begins_with(std::string_view head, std::string_view begin) {
  const auto same = [](char small, char any) {
    return static_cast<unsigned char>(small) == std::tolower(static_cast<unsigned char>(any));
  };
  return head.size() >= begin.size() && std::equal(begin.begin(), begin.end(), head.begin(), same);
}

}  // namespace

std::string_view foreign_file(std::string_view head) {
  head.remove_prefix(std::min(head.find_first_not_of("\xEF\xBB\xBF \t\r\n"), head.size()));
  for (const auto& kind : kKinds) {
    if (begins_with(head, kind.begin)) return kind.what;
  }
  return {};
}

}  // namespace rio::io
