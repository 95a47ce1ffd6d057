// SPDX-License-Identifier: BSD-3-Clause
// Runs a fuzz target on files, and on mutations of them that are the same in every run.
//   fuzz_NAME_replay [--mutations N] FILE|FOLDER...
// A finding ends it with a signal; the last line then names the input, which is left in `finding`.
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "fuzz/fuzz.hpp"
#include "support/temp_dir.hpp"

namespace {

namespace fs = std::filesystem;
using Random = std::minstd_rand;

std::string running;  // the input, for the signal handler
char label[256];

extern "C" void on_signal(int signal) {
  const auto print = [](const char* text, std::size_t size) {
    return write(STDERR_FILENO, text, size) >= 0;
  };
  std::FILE* file = std::fopen("finding", "wb");
  const bool left = file != nullptr && std::fwrite(running.data(), 1, running.size(), file) > 0 &&
                    std::fclose(file) == 0;
  print("finding: ", 9);
  print(label, std::strlen(label));
  print(left ? ", left in the file `finding`\n" : "\n", left ? 29 : 1);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::exists(path)) {
    std::fprintf(stderr, "cannot read %s\n", path.c_str());
    std::exit(2);
  }
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// A few bytes changed, cut, doubled, or replaced by a part of another input or by a length at its
/// worst.
std::string mutated(std::string text, const std::string& other, Random& random) {
  static const std::string kLengths[] = {
      {"\xFF\xFF\xFF\xFF", 4}, {"\xFF\xFF\xFF\x7F", 4}, {"\0\0\0\x40", 4}, {"\0\0\0\0", 4}};
  const auto below = [&random](std::size_t limit) {
    return random() % std::max<std::size_t>(limit, 1);
  };
  for (std::size_t n = 1 + below(4); n > 0; --n) {
    const std::size_t at = below(text.size());
    const std::size_t length = 1 + below(below(8) == 0 ? text.size() : 16);
    switch (below(7)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 1:
        if (!text.empty()) text[at] = static_cast<char>(below(256));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), length));
        break;
      case 4:
        text.insert(at, 1, static_cast<char>(below(256)));
        break;
      case 5:
        text.replace(at, 4, kLengths[below(4)]);
        break;
      default:
        text.replace(at, length, other.substr(below(other.size()), length));
    }
  }
  return text;
}

void run(const std::string& name, const std::string& text) {
  running = text;
  std::snprintf(label, sizeof label, "%s", name.c_str());
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

int main(int argc, char** argv) {
  int mutations = 0;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--mutations" && i + 1 < argc) {
      mutations = std::atoi(argv[++i]);
    } else {
      for (const fs::path& file : files_of(argv[i])) files.push_back(file);
    }
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: %s [--mutations N] FILE|FOLDER...\n", argv[0]);
    return 2;
  }
  for (const int signal : {SIGABRT, SIGFPE, SIGSEGV}) std::signal(signal, on_signal);
  std::vector<std::string> texts;
  for (const fs::path& file : files) {
    texts.push_back(rio::test::text_of(file));
    run(file.filename(), texts.back());
  }
  Random random(1);
  for (int i = 0; i < mutations; ++i) {
    const std::size_t seed = random() % texts.size();
    const std::string text = mutated(texts[seed], texts[random() % texts.size()], random);
    run(files[seed].filename().string() + ", mutation " + std::to_string(i), text);
  }
  std::printf("%zu inputs and %d mutations, no finding\n", files.size(), mutations);
  return 0;
}
