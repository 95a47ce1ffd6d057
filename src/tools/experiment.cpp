// SPDX-License-Identifier: BSD-3-Clause
// `rio experiment`: passes its arguments to the program `rio-lab` in the same folder.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands.hpp"

namespace rio::tools {

void experiment(const std::vector<std::string>& arguments) {
  const std::filesystem::path lab =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "rio-lab";
  if (!std::filesystem::exists(lab)) {
    throw std::runtime_error("the experiments are a program of their own that was not built: " +
                             lab.string() + " does not exist. Configure with -DRIO_BUILD_LAB=ON");
  }
  std::string program = lab.string();
  std::vector<std::string> texts = arguments;
  std::vector<char*> argv = {program.data()};
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw std::runtime_error(lab.string() + ": " + std::strerror(errno));
}

}  // namespace rio::tools
