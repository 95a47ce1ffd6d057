// SPDX-License-Identifier: BSD-3-Clause
#include "yaml.hpp"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>

#include "decimal.hpp"
#include "rio/io/csv.hpp"
#include "rio/io/units.hpp"

namespace rio::io {

namespace {

void reject_duplicates(const YamlFile& file, const YAML::Node& node) {
  std::set<std::string> seen;
  for (const auto& entry : node) {
    if (!node.IsMap()) {
      reject_duplicates(file, entry);
      continue;
    }
    const std::string& key = entry.first.Scalar();
    if (!seen.insert(key).second) fail_at(file, entry.first, "duplicate key \"" + key + "\"");
    reject_duplicates(file, entry.second);
  }
}

/// Levenshtein distance.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replace, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// Parses a document without building it. An anchor that contains itself would have no end.
class NoEvents : public YAML::EventHandler {
 public:
  using Style = YAML::EmitterStyle::value;
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (std::find(open_.begin(), open_.end(), anchor) == open_.end()) return;
    throw YAML::ParserException(mark, "an anchor that contains itself");
  }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                       Style) override {
    open_.push_back(anchor);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor, Style) override {
    open_.push_back(anchor);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  std::vector<YAML::anchor_t> open_;  // of the nodes around
};

/// Not YAML::LoadAll: if the parser makes no progress, as before a comma, it loops for ever.
bool has_two_documents(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  NoEvents none;
  return parser.HandleNextDocument(none) && parser.HandleNextDocument(none);
}

std::string last_part(const std::string& key) {
  return key.substr(key.rfind('.') + 1);
}

}  // namespace

YamlFile parse_yaml(const std::string& text, const std::string& name) {
  YamlFile file{name, {}, true};
  try {
    if (has_two_documents(text))
      throw std::runtime_error(name + ": holds more than one document, or a comma in place of one");
    file.root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(name + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
  if (!file.root.IsMap() && !file.root.IsNull()) fail_at(file, file.root, "not a map of keys");
  reject_duplicates(file, file.root);
  return file;
}

YamlFile load_yaml(const std::filesystem::path& path) {
  return parse_yaml(read_text(path), path.string());
}

void fail_at(const YamlFile& file, const YAML::Node& node, const std::string& what) {
  const std::string line = file.has_lines ? ":" + std::to_string(node.Mark().line + 1) : "";
  throw std::runtime_error(file.name + line + ": " + what);
}

double yaml_number(const YamlFile& file, const YAML::Node& node, const std::string& key,
                   const char* si_unit) {
  if (!node.IsScalar()) fail_at(file, node, key + ": a single number is expected");
  try {
    return parse_quantity(node.Scalar(), si_unit);
  } catch (const std::invalid_argument& error) {
    fail_at(file, node, key + ": " + error.what());
  }
}

std::vector<double> yaml_numbers(const YamlFile& file, const YAML::Node& node,
                                 const std::string& key, const char* si_unit, std::size_t count) {
  if (!node.IsSequence() || node.size() != count) {
    fail_at(file, node, key + ": a list of " + std::to_string(count) + " numbers is expected");
  }
  std::vector<double> values;
  for (const YAML::Node& item : node) values.push_back(yaml_number(file, item, key, si_unit));
  return values;
}

Vector3d yaml_vector(const YamlFile& file, const YAML::Node& node, const std::string& key,
                     const char* si_unit) {
  const std::vector<double> v = yaml_numbers(file, node, key, si_unit, 3);
  return {v[0], v[1], v[2]};
}

Quaternion yaml_quaternion(const YamlFile& file, const YAML::Node& node, const std::string& key) {
  const std::vector<double> v = yaml_numbers(file, node, key, "", 4);
  const auto q = unit_quaternion(v[0], v[1], v[2], v[3]);
  if (!q) fail_at(file, node, key + ": not a unit quaternion");
  return *q;
}

std::string did_you_mean(const std::string& key, const std::vector<std::string>& candidates) {
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(2, last_part(key).size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t same_section = edit_distance(key, candidate);
    const std::size_t elsewhere = edit_distance(last_part(key), last_part(candidate)) + 1;
    const std::size_t distance = std::min(same_section, elsewhere);
    if (distance >= best_distance) continue;
    best = &candidate;
    best_distance = distance;
  }
  return best == nullptr ? "" : ", did you mean \"" + *best + "\"?";
}

}  // namespace rio::io
