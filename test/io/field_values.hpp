// SPDX-License-Identifier: BSD-3-Clause
// Structs with a table of fields: their values, and whether each of them survives a file.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <type_traits>

#include "rio/core/field.hpp"

namespace rio::io {

/// Every field as text that is exact to the bit.
using Values = std::map<std::string, std::string>;

struct ToText {
  std::string operator()(double v) const {
    char text[40];
    std::snprintf(text, sizeof text, "%a ", v);
    return text;
  }
  std::string operator()(const std::string& v) const { return v; }
  std::string operator()(const Vector3d& v) const {
    return (*this)(v.x()) + (*this)(v.y()) + (*this)(v.z());
  }
  std::string operator()(const Quaternion& q) const {
    return (*this)(q.w()) + (*this)(Vector3d(q.vec()));
  }
  template <class Whole>
  std::string operator()(Whole v) const {
    return std::to_string(static_cast<std::uint64_t>(v));
  }
};

template <class Object>
Values values(const Object& object) {
  Values all;
  visit_fields(object, [&all](const FieldInfo& info, const auto& value) {
    EXPECT_TRUE(all.emplace(info.key, ToText{}(value)).second) << "twice: " << info.key;
  });
  return all;
}

/// Another allowed value: numbers move a thousandth of the way towards a finite bound.
struct Change {
  void operator()(const FieldInfo& i, double& v) const {
    const double bound = v < i.max && std::isfinite(i.max) ? i.max : i.min;
    v = std::isfinite(v) ? v + (bound - v) / 1000.0 : 100.0 / 3.0;
  }
  void operator()(const FieldInfo& i, int& v) const { v += v < i.max ? 1 : -1; }
  void operator()(const FieldInfo&, std::uint64_t& v) const {
    v = std::numeric_limits<std::uint64_t>::max();
  }
  void operator()(const FieldInfo&, bool& v) const { v = !v; }
  template <class Enum>
  requires std::is_enum_v<Enum>
  void operator()(const FieldInfo&, Enum& v) const {
    v = static_cast<Enum>(static_cast<int>(v) == 0 ? 1 : 0);
  }
  void operator()(const FieldInfo&, std::string& v) const { v = "/a folder/\"\xc3\xa9\" #\\1.tum"; }
  void operator()(const FieldInfo&, Vector3d& v) const { v += Vector3d(0.1, 1.0 / 3.0, 0.2); }
  void operator()(const FieldInfo&, Quaternion& v) const {
    v = Quaternion(0.1, 0.7, -1.0 / 3.0, 0.4).normalized();
  }
};

/// Each field changed alone comes back from a file, and nothing else changes.
/// @param through writes and reads an object
template <class Object, class Through>
void expect_each_field_round_trips(std::size_t at_least, const Through& through) {
  const Values defaults = values(Object{});
  EXPECT_GT(defaults.size(), at_least);
  for (const auto& [key, text] : defaults) {
    Object changed;
    visit_fields(changed, [&key = key](const FieldInfo& info, auto& value) {
      if (key == info.key) Change{}(info, value);
    });
    EXPECT_NE(values(changed).at(key), text) << key;
    EXPECT_EQ(values(through(changed)), values(changed)) << key;
  }
}

}  // namespace rio::io
