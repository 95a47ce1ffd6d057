// SPDX-License-Identifier: BSD-3-Clause
#include "version.hpp"

#include <Eigen/Core>

#include "commit.hpp"

namespace rio::tools {

std::string version_text() {
  std::string formats;
#ifdef RIO_HAS_BZ2
  formats += " bzip2";
#endif
#ifdef RIO_HAS_LZ4
  formats += " lz4";
#endif
#ifdef RIO_HAS_ZSTD
  formats += " zstd";
#endif
#ifdef RIO_HAS_SQLITE3
  formats += " sqlite3";
#endif
  const std::string eigen = std::to_string(EIGEN_WORLD_VERSION) + "." +
                            std::to_string(EIGEN_MAJOR_VERSION) + "." +
                            std::to_string(EIGEN_MINOR_VERSION);
  return RIO_VERSION " (commit " RIO_COMMIT ")\n" RIO_COMPILER ", " RIO_BUILD_OPTIONS ", Eigen " +
         eigen + "; recordings with:" + (formats.empty() ? " no compression" : formats);
}

}  // namespace rio::tools
