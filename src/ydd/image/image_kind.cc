// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/image_kind.h"

#include <array>

#include <fmt/format.h>

namespace ydd {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::size_t at;
  std::string_view bytes;
  std::string_view kind;
};

constexpr auto kSignatures = std::to_array<Signature>({
    {0, "\x76\x2f\x31\x01"sv, "an OpenEXR image"},
    {0, "II*\0"sv, "a TIFF image"},
    {0, "MM\0*"sv, "a TIFF image"},
    {0, "GIF8"sv, "a GIF image"},
    {0, "BM"sv, "a BMP image"},
    {8, "WEBP"sv, "a WebP image"},
    {0, "#?RADIANCE"sv, "a Radiance HDR image"},
    {0, "Pf"sv, "a PFM image of floats"},
    {0, "PF"sv, "a PFM image of floats"},
    {0, "P2"sv, "a PGM image"},
    {0, "P5"sv, "a PGM image"},
    {0, "P3"sv, "a PPM image"},
    {0, "P6"sv, "a PPM image"},
    {4, "jP  "sv, "a JPEG 2000 image"},
    {0, "\xff\x4f\xff\x51"sv, "a JPEG 2000 image"},
    {4, "JXL "sv, "a JPEG XL image"},
    {0, "\xff\x0a"sv, "a JPEG XL image"},
    {4, "ftyp"sv, "a HEIF, AVIF or video file"},
    {0, "\x93NUMPY"sv, "a NumPy array"},
    {0, "PK\x03\x04"sv, "a ZIP archive (.npz?)"},
    {0, "\x1f\x8b"sv, "a gzip archive"},
    {0, "MATLAB 5.0"sv, "a MATLAB file"},
    {0, "\x89HDF"sv, "an HDF5 file"},
    {0, "version https://git-lfs"sv, "a Git LFS pointer (fetch the file by 'git lfs pull')"},
    {0, "<!DOCTYPE"sv, "a web page (a download that failed?)"},
    {0, "<!doctype"sv, "a web page (a download that failed?)"},
    {0, "<html"sv, "a web page (a download that failed?)"},
});

}  // namespace

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"sv); }

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8\xff"sv); }

std::optional<std::string_view> kind_of_file(std::string_view bytes) {
  for (const Signature& signature : kSignatures) {
    if (bytes.size() < signature.at) continue;
    if (bytes.substr(signature.at).starts_with(signature.bytes)) return signature.kind;
  }
  return std::nullopt;
}

std::string describe(const ImageHeader& header) {
  const bool is_png = header.format == ImageHeader::Format::png;
  const bool has_alpha = is_png && header.channels % 2 == 0;
  const bool is_cmyk = !is_png && header.channels == 4;
  std::string_view colours = header.channels >= 3 ? "colour" : "grey";
  if (header.palette) colours = "palette";
  if (is_cmyk) colours = "CMYK";
  return fmt::format("{} {} {} of {} bit{} a channel{}", header.interlaced ? "an interlaced" : "a",
                     colours, is_png ? "PNG" : "JPEG", header.bits_per_channel,
                     header.bits_per_channel == 1 ? "" : "s", has_alpha ? ", with alpha" : "");
}

}  // namespace ydd
