// SPDX-License-Identifier: BSD-3-Clause
#include "recording_folder.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <utility>

namespace rio::bag {

namespace fs = std::filesystem;

fs::path plain_name(const fs::path& path) {
  return path.extension() == ".zstd" || path.extension() == ".zst" ? path.stem() : path.filename();
}

std::int64_t number_of(const fs::path& path) {
  const std::string stem = plain_name(path).stem().string();
  const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
  const std::size_t count = stem.size() - digits;
  return count == 0 || count > 9 ? -1 : std::stoll(stem.substr(digits));
}

std::string without_digits(const fs::path& path) {
  std::string name = plain_name(path).string();
  std::erase_if(name, [](char c) { return c >= '0' && c <= '9'; });
  return name;
}

namespace {

/// The files in a folder for which `keep(path)`; parts in the order of their numbers.
template <class Keep>
std::vector<fs::path> files_of(const fs::path& folder, const Keep& keep,
                               fs::directory_options how = fs::directory_options::none) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, how)) {
    if (keep(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(number_of(a), a) < std::pair(number_of(b), b);
  });
  return files;
}

/// Another file in the folder is the better one: unpacked, or mended by rosbag reindex.
bool is_superseded(const fs::path& file) {
  if (plain_name(file) != file.filename()) return fs::exists(file.parent_path() / plain_name(file));
  return file.stem().extension() == ".orig" &&
         fs::exists(file.parent_path() / file.stem().stem().replace_extension(file.extension()));
}

std::vector<fs::path> bags_in(const fs::path& folder,
                              fs::directory_options how = fs::directory_options::none) {
  const auto is_bag = [](const fs::path& file) {
    const fs::path extension = plain_name(file).extension();
    const bool known = extension == ".db3" || extension == ".mcap" || extension == ".bag";
    const bool hidden = file.filename().string().starts_with('.');  // "._flight.bag" of macOS
    return known && !hidden && !is_superseded(file) && !fs::is_directory(file);
  };
  return files_of(folder, is_bag, how);
}

}  // namespace

std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> bags = bags_in(folder);
  if (!bags.empty()) return bags;
  return files_of(folder, [](const fs::path& below) {
    constexpr auto kReadable = fs::directory_options::skip_permission_denied;
    return fs::is_directory(below) && !bags_in(below, kReadable).empty();
  });
}

std::vector<fs::path> not_closed(const fs::path& folder, const fs::path& part) {
  return files_of(folder, [&](const fs::path& file) {
    return without_digits(file) == without_digits(part) + ".active";
  });
}

std::string missing_before(const std::vector<fs::path>& files, std::size_t i) {
  const std::int64_t first = i == 0 ? 0 : number_of(files[i - 1]) + 1;
  const std::int64_t last = number_of(files[i]) - 1;
  if (last < first || without_digits(files[i]) != without_digits(files[0])) return {};
  return last == first ? fmt::format("part {} is missing", first)
                       : fmt::format("parts {} to {} are missing", first, last);
}

std::string missing_after(const std::vector<fs::path>& files) {
  const fs::path metadata = files.back().parent_path() / "metadata.yaml";
  if (!fs::exists(metadata)) return {};
  std::vector<std::string> missing;
  try {
    const YAML::Node info = YAML::LoadFile(metadata.string())["rosbag2_bagfile_information"];
    for (const YAML::Node& name : info["relative_file_paths"]) {
      const fs::path listed = fs::path(name.Scalar()).filename();
      const bool behind = number_of(listed) > number_of(files.back()) &&
                          without_digits(listed) == without_digits(files.back());
      if (behind) missing.push_back(listed.string());
    }
  } catch (const YAML::Exception&) {  // as if there were none
  }
  if (missing.empty()) return {};
  return fmt::format("{} of {} {} missing", fmt::join(missing, ", "), metadata.filename().string(),
                     missing.size() == 1 ? "is" : "are");
}

}  // namespace rio::bag
