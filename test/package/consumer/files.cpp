// SPDX-License-Identifier: BSD-3-Clause
// The sensor files of a folder as options.
#include <rio/files.hpp>
#include <rio/rio.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  rio::files::Sources sources;
  sources.sensors = argv[1];
  const rio::Options options = rio::files::load(sources);
  const bool mounted = options.radar.T_BS.translation.norm() > 0.0;
  return mounted && rio::Odometry::create(options) ? 0 : 1;
}
