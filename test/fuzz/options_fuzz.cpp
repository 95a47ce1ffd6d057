// SPDX-License-Identifier: BSD-3-Clause
// Option files: valid options that read back the same, or a std::runtime_error that names the file
// and leaves the options alone.
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/io/options_yaml.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = rio::fuzz::text_of(data, size);
  static const std::string kDefault = rio::io::options_as_yaml({});
  rio::Options options;
  if (!rio::fuzz::reads("FILE:", [&] { rio::io::parse_options(text, "FILE", &options); })) {
    RIO_FUZZ_CHECK(rio::io::options_as_yaml(options) == kDefault);
    return 0;
  }
  RIO_FUZZ_CHECK(options.validate());
  const std::string written = rio::io::options_as_yaml(options);
  rio::Options again;
  rio::io::parse_options(written, "written", &again);
  RIO_FUZZ_CHECK(rio::io::options_as_yaml(again) == written);
  return 0;
}
