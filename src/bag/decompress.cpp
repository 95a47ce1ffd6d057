// SPDX-License-Identifier: BSD-3-Clause
#include "decompress.hpp"

#ifdef RIO_HAS_BZ2
#include <bzlib.h>
#endif
#ifdef RIO_HAS_LZ4
#include <lz4frame.h>
#endif
#ifdef RIO_HAS_ZSTD
#include <zstd.h>
#endif

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "chunk.hpp"
#include "formats.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

using Declared = std::optional<std::uint64_t>;
using Output = std::vector<std::uint8_t>;

/// What one call of a library took and gave [bytes].
struct Step {
  std::size_t taken = 0;
  std::size_t made = 0;
  bool ended = false;  ///< the compressed data
  std::string error{};
};

/// Calls `step(in, room)` until the compressed data end; the output grows up to the declared size.
template <class Call>
std::string decompress_by(const Call& step, Bytes in, const Declared& declared, Output* out) {
  constexpr std::size_t kFirst = 1 << 16;
  const auto limit = static_cast<std::size_t>(declared.value_or(kMaxRecord));
  std::size_t used = 0;
  Step done;
  do {
    if (used == out->size()) out->resize(std::min(limit, std::max(kFirst, 2 * used)));
    done = step(in, std::span(*out).subspan(used));
    in = in.subspan(done.taken);
    used += done.made;
  } while (!done.ended && done.error.empty() && done.taken + done.made > 0);
  out->resize(used);
  if (!done.error.empty()) return done.error;
  if (done.ended && used == declared.value_or(used)) return "";
  return fmt::format("its compressed data gives {} bytes instead of {}", used, limit);
}

#ifdef RIO_HAS_BZ2
std::string decompress_bz2(Bytes all, const Declared& declared, Output* out) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return "bzip2 cannot start";
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> end(&stream,
                                                                       &BZ2_bzDecompressEnd);
  const auto step = [&stream](Bytes in, std::span<std::uint8_t> room) -> Step {
    // one extra byte: the checksum is verified when the end of the stream is reached
    std::uint8_t spare = 0;
    const std::span<std::uint8_t> to = room.empty() ? std::span(&spare, 1) : room;
    stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
    stream.avail_in = static_cast<unsigned>(in.size());
    stream.next_out = reinterpret_cast<char*>(to.data());
    stream.avail_out = static_cast<unsigned>(to.size());
    const int code = BZ2_bzDecompress(&stream);
    const std::size_t made = to.size() - stream.avail_out;
    if (code != BZ_OK && code != BZ_STREAM_END) return {.error = "its bzip2 data is damaged"};
    if (room.empty() && made > 0) return {.error = "its bzip2 data gives more bytes than declared"};
    return {in.size() - stream.avail_in, made, code == BZ_STREAM_END};
  };
  return decompress_by(step, all, declared, out);
}
#endif

#ifdef RIO_HAS_LZ4
std::string decompress_lz4(Bytes all, const Declared& declared, Output* out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
    return "lz4 cannot start";
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> end(
      context, &LZ4F_freeDecompressionContext);
  const auto step = [context](Bytes in, std::span<std::uint8_t> room) -> Step {
    std::size_t taken = in.size();
    std::size_t made = room.size();
    const std::size_t hint =
        LZ4F_decompress(context, room.data(), &made, in.data(), &taken, nullptr);
    if (LZ4F_isError(hint) != 0) return {.error = "its lz4 data is damaged"};
    return {taken, made, hint == 0};
  };
  return decompress_by(step, all, declared, out);
}
#endif

#ifdef RIO_HAS_ZSTD
std::string decompress_zstd(Bytes all, const Declared& declared, Output* out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  const auto step = [&context](Bytes in, std::span<std::uint8_t> room) -> Step {
    ZSTD_inBuffer input{in.data(), in.size(), 0};
    ZSTD_outBuffer output{room.data(), room.size(), 0};
    const std::size_t hint = ZSTD_decompressStream(context.get(), &output, &input);
    if (ZSTD_isError(hint) != 0) return {.error = "its zstd data is damaged"};
    return {input.pos, output.pos, hint == 0};
  };
  return decompress_by(step, all, declared, out);
}
#endif

/// A file of zstd frames into another one, replaced; the error, or empty.
std::string decompress_file([[maybe_unused]] const fs::path& from,
                            [[maybe_unused]] const fs::path& to) {
#ifdef RIO_HAS_ZSTD
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  std::ifstream packed(from, std::ios::binary);
  std::ofstream plain(to, std::ios::binary);
  std::vector<char> in(ZSTD_DStreamInSize());
  std::vector<char> out(ZSTD_DStreamOutSize());
  while (packed && plain) {
    packed.read(in.data(), static_cast<std::streamsize>(in.size()));
    ZSTD_inBuffer input{in.data(), static_cast<std::size_t>(packed.gcount()), 0};
    for (bool full = true; input.pos < input.size || full;) {
      ZSTD_outBuffer output{out.data(), out.size(), 0};
      if (ZSTD_isError(ZSTD_decompressStream(context.get(), &output, &input)) != 0) {
        return plain.tellp() > 0 ? "" : "its zstd data is damaged";  // used up to there
      }
      plain.write(out.data(), static_cast<std::streamsize>(output.pos));
      full = output.pos == output.size;
    }
  }
  return plain ? "" : "is compressed with zstd, and there is no room to unpack it";
#else
  return "is compressed with zstd: unpack it with `zstd -d`";
#endif
}

}  // namespace

std::string decompress(std::string_view method, [[maybe_unused]] Bytes in,
                       std::optional<std::uint64_t> declared, std::vector<std::uint8_t>* out) {
  out->clear();
  if (declared && *declared > kMaxRecord) return "declares more than 1 GiB";
#ifdef RIO_HAS_BZ2
  if (method == "bz2") return decompress_bz2(in, declared, out);
#endif
#ifdef RIO_HAS_LZ4
  if (method == "lz4") return decompress_lz4(in, declared, out);
#endif
#ifdef RIO_HAS_ZSTD
  if (method == "zstd") return decompress_zstd(in, declared, out);
#endif
  if (method == "bz2" || method == "lz4" || method == "zstd") {
    throw std::runtime_error(fmt::format(
        "this recording needs lib{0}, which rio was built without: install lib{0}-dev and build "
        "again",
        method));
  }
  return "unknown compression \"" + std::string(method.substr(0, 40)) + "\"";
}

std::string_view compression_of(Bytes in) {
  const std::string_view bytes(reinterpret_cast<const char*>(in.data()), in.size());
  if (bytes.starts_with(kZstdMagic)) return "zstd";
  return bytes.starts_with(kLz4Magic) ? "lz4" : "";
}

fs::path unpacked(const fs::path& path) {
  /// Removed at the end of the program.
  struct Copy {
    fs::path path;
    ~Copy() {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
  };
  static std::map<std::pair<fs::path, std::uintmax_t>, Copy> copies;
  const auto key = std::pair(fs::absolute(path), fs::file_size(path));
  const auto known = copies.find(key);
  if (known != copies.end()) return known->second.path;
  std::string name = (fs::temp_directory_path() / "rio_unpacked_XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) throw std::runtime_error(name + ": cannot be written");
  close(file);
  copies[key].path = name;
  const std::string error = decompress_file(path, name);
  if (error.empty()) return name;
  copies.erase(key);
  throw std::runtime_error(path.string() + ": " + error);
}

std::uint32_t crc32(Bytes bytes) {
  static const std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ (value % 2 != 0 ? 0xEDB88320U : 0U);
      table[i] = value;
    }
    return table;
  }();
  std::uint32_t crc = ~0U;
  for (const std::uint8_t byte : bytes) crc = (crc >> 8) ^ kTable[(crc ^ byte) & 0xFFU];
  return ~crc;
}

}  // namespace rio::bag
