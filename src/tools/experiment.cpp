// SPDX-License-Identifier: BSD-3-Clause
// `rio experiment`: starts the program of the experiments.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line.hpp"

namespace rio::tools {

namespace {

/// Hands the arguments to the program rio-lab in the same folder.
[[noreturn]] void experiment(const std::vector<std::string>& arguments) {
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

}  // namespace

/// rio-lab has its own options and its own help.
void add_experiment_command(CLI::App& app) {
  const Command command(
      app, "experiment",
      "Answer a question with many simulated flights or recordings (starts rio-lab)");
  command->prefix_command();
  command->set_help_flag();
  command->callback([command] { experiment(command->remaining()); });
}

}  // namespace rio::tools
