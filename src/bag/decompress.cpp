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

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "chunk.hpp"
#include "formats.hpp"

namespace rio::bag {

namespace {

/// The output of a decompressor, which grows up to the declared size.
class Sink {
 public:
  Sink(std::optional<std::uint64_t> declared, std::vector<std::uint8_t>* out)
      : declared_(declared),
        limit_(static_cast<std::size_t>(declared.value_or(kMaxRecord))),
        out_(out) {
    out_->clear();
  }
  ~Sink() { out_->resize(used_); }
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;

  /// Free space; empty when the declared size is reached.
  std::span<std::uint8_t> room() {
    constexpr std::size_t kFirst = 1 << 16;
    if (used_ == out_->size()) out_->resize(std::min(limit_, std::max(kFirst, 2 * used_)));
    return std::span(*out_).subspan(used_);
  }
  void add(std::size_t count) { used_ += count; }
  /// The error when the compressed data are used up or in excess.
  std::string verdict(bool over) const {
    if (over && used_ == declared_.value_or(used_)) return "";
    return "its compressed data gives " + std::to_string(used_) + " bytes instead of " +
           std::to_string(limit_);
  }

 private:
  std::optional<std::uint64_t> declared_;
  std::size_t limit_;
  std::size_t used_ = 0;
  std::vector<std::uint8_t>* out_;
};

#ifdef RIO_HAS_BZ2
std::string decompress_bz2(Bytes in, Sink* sink) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return "bzip2 cannot start";
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> end(&stream,
                                                                       &BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
  stream.avail_in = static_cast<unsigned>(in.size());
  for (;;) {
    // one extra byte: the checksum is verified when the end of the stream is reached
    std::uint8_t spare = 0;
    const std::span<std::uint8_t> room = sink->room();
    stream.next_out = reinterpret_cast<char*>(room.empty() ? &spare : room.data());
    const auto size = static_cast<unsigned>(std::max<std::size_t>(room.size(), 1));
    stream.avail_out = size;
    const unsigned before = stream.avail_in;
    const int code = BZ2_bzDecompress(&stream);
    const unsigned made = size - stream.avail_out;
    if (!room.empty()) sink->add(made);
    if (code == BZ_STREAM_END) return sink->verdict(room.empty() ? made == 0 : true);
    if (code != BZ_OK) return "its bzip2 data is damaged";
    if (made == 0 && before == stream.avail_in) return sink->verdict(false);
    if (room.empty() && made > 0) return "its bzip2 data gives more bytes than declared";
  }
}
#endif

#ifdef RIO_HAS_LZ4
std::string decompress_lz4(Bytes in, Sink* sink) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
    return "lz4 cannot start";
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> end(
      context, &LZ4F_freeDecompressionContext);
  for (std::size_t hint = 1; hint != 0;) {
    const std::span<std::uint8_t> room = sink->room();
    std::size_t made = room.size();
    std::size_t taken = in.size();
    hint = LZ4F_decompress(context, room.data(), &made, in.data(), &taken, nullptr);
    if (LZ4F_isError(hint) != 0) return "its lz4 data is damaged";
    sink->add(made);
    in = in.subspan(taken);
    if (hint != 0 && made == 0 && taken == 0) return sink->verdict(false);
  }
  return sink->verdict(true);
}
#endif

#ifdef RIO_HAS_ZSTD
std::string decompress_zstd(Bytes in, Sink* sink) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  ZSTD_inBuffer input{in.data(), in.size(), 0};
  for (std::size_t hint = 1; hint != 0;) {
    const std::span<std::uint8_t> room = sink->room();
    ZSTD_outBuffer output{room.data(), room.size(), 0};
    const std::size_t before = input.pos;
    hint = ZSTD_decompressStream(context.get(), &output, &input);
    if (ZSTD_isError(hint) != 0) return "its zstd data is damaged";
    sink->add(output.pos);
    if (hint != 0 && output.pos == 0 && input.pos == before) return sink->verdict(false);
  }
  return sink->verdict(true);
}
#endif

}  // namespace

std::string decompress(std::string_view method, [[maybe_unused]] Bytes in,
                       std::optional<std::uint64_t> declared, std::vector<std::uint8_t>* out) {
  out->clear();
  if (declared && *declared > kMaxRecord) return "declares more than 1 GiB";
  [[maybe_unused]] Sink sink(declared, out);
#ifdef RIO_HAS_BZ2
  if (method == "bz2") return decompress_bz2(in, &sink);
#endif
#ifdef RIO_HAS_LZ4
  if (method == "lz4") return decompress_lz4(in, &sink);
#endif
#ifdef RIO_HAS_ZSTD
  if (method == "zstd") return decompress_zstd(in, &sink);
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

std::string decompress_file([[maybe_unused]] const std::filesystem::path& from,
                            [[maybe_unused]] const std::filesystem::path& to) {
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
