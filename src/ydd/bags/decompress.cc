// SPDX-License-Identifier: Apache-2.0
//
// The compressions of bags. Each library may be missing when the program is built; then a bag that
// needs it says so.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "ydd/bags/byte_source.h"
#include "ydd/base/one_line.h"

#ifdef YDD_HAS_bz2
#include <bzlib.h>
#endif
#ifdef YDD_HAS_lz4
#include <lz4frame.h>
#endif
#ifdef YDD_HAS_zstd
#include <zstd.h>
#endif

namespace ydd::bags {
namespace {

using Unpack = bool (*)(std::string_view from, std::string& to);

#ifdef YDD_HAS_bz2
bool unpack_bz2(std::string_view from, std::string& to) {
  auto size = static_cast<unsigned>(to.size());
  const int code = BZ2_bzBuffToBuffDecompress(to.data(), &size, const_cast<char*>(from.data()),
                                              static_cast<unsigned>(from.size()), 0, 0);
  return code == BZ_OK && size == to.size();
}
#else
const Unpack unpack_bz2 = nullptr;
#endif

#ifdef YDD_HAS_lz4
bool unpack_lz4(std::string_view from, std::string& to) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) return false;
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
      context, &LZ4F_freeDecompressionContext);
  std::size_t read = 0, written = 0, hint = 1;
  while (hint != 0 && read < from.size()) {
    std::size_t in = from.size() - read, out = to.size() - written;
    hint = LZ4F_decompress(context, to.data() + written, &out, from.data() + read, &in, nullptr);
    if (LZ4F_isError(hint) || (in == 0 && out == 0)) return false;
    read += in;
    written += out;
  }
  return hint == 0 && written == to.size();
}
#else
const Unpack unpack_lz4 = nullptr;
#endif

#ifdef YDD_HAS_zstd
bool unpack_zstd(std::string_view from, std::string& to) {
  const std::size_t size = ZSTD_decompress(to.data(), to.size(), from.data(), from.size());
  return ZSTD_isError(size) == 0 && size == to.size();
}
#else
const Unpack unpack_zstd = nullptr;
#endif

}  // namespace

Result<std::string> decompressed(std::string_view kind, std::string_view bytes,
                                 std::uint64_t size) {
  Unpack unpack = nullptr;
  const char* library = nullptr;
  if (kind == "bz2") unpack = unpack_bz2, library = "libbz2";
  if (kind == "lz4") unpack = unpack_lz4, library = "liblz4";
  if (kind == "zstd") unpack = unpack_zstd, library = "libzstd";
  if (library == nullptr) {
    return Error{fmt::format("a compression that is not known ('{}'); bz2, lz4 and zstd are",
                             on_one_line(kind.substr(0, 20)))};
  }
  if (unpack == nullptr) {
    return Error{fmt::format("compressed with {}, which this program was built without ({})", kind,
                             library)};
  }
  // What is much smaller than it says was made to take memory; bz2 packs best, by 1 to 10,000.
  constexpr std::uint64_t kMostRatio = 20'000;
  if (size > kLargestPiece || size / kMostRatio > bytes.size()) {
    return Error{fmt::format("{} bytes that say they become {}", bytes.size(), size)};
  }
  std::string out(size, '\0');
  if (!unpack(bytes, out)) return Error{fmt::format("damaged {} data", kind)};
  return out;
}

bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xB5\x2F\xFD"); }

Result<std::string> decompressed_zstd(std::string_view bytes) {
  std::uint64_t size = 0;
#ifdef YDD_HAS_zstd
  size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) {
    return Error{"damaged zstd data"};
  }
#endif
  return decompressed("zstd", bytes, size);
}

}  // namespace ydd::bags
