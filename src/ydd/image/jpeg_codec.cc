// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/jpeg_codec.h"

#include <csetjmp>
#include <cstddef>
#include <cstdio>  // jpeglib.h needs it
#include <cstdlib>
#include <memory>

#include <jerror.h>
#include <jpeglib.h>

namespace ydd {
namespace {

// Why not OpenCV: it hides the decoder's warnings, by which alone a damaged file can be told, and
// lets them be printed.

// A progressive file has about ten; each may pass over all pixels for a few bytes.
constexpr int kMaxScans = 100;
// More before a marker are not a webcam's padding: decoding lost its place.
constexpr int kMaxStrayBytes = 8;

struct ErrorManager {
  jpeg_error_mgr base;  // first: libjpeg knows only this part
  std::jmp_buf leave;
};

extern "C" {
void leave_on_error(j_common_ptr info) {
  std::longjmp(reinterpret_cast<ErrorManager*>(info->err)->leave, 1);  // NOLINT: libjpeg's way
}

/// At once: a file that ends early would be passed over scan by scan with nothing in it.
void leave_on_warning(j_common_ptr info, int level) {
  const jpeg_error_mgr& errors = *info->err;
  const bool is_warning = level < 0;
  const bool is_stray =
      errors.msg_code == JWRN_EXTRANEOUS_DATA && errors.msg_parm.i[0] <= kMaxStrayBytes;
  if (is_warning && !is_stray && errors.msg_code != JWRN_ADOBE_XFORM) leave_on_error(info);
}

void leave_on_many_scans(j_common_ptr info) {
  const auto* const reader = reinterpret_cast<j_decompress_ptr>(info);  // NOLINT: libjpeg's way
  if (reader->input_scan_number > kMaxScans) leave_on_error(info);
}

void print_nothing(j_common_ptr) {}
}

jpeg_error_mgr* silent_errors(ErrorManager& errors) {
  jpeg_std_error(&errors.base);
  errors.base.error_exit = leave_on_error;
  errors.base.emit_message = leave_on_warning;
  errors.base.output_message = print_nothing;
  return &errors.base;
}

/// Fills `pixels`, of the size in `header`. False if the file is damaged. Holds nothing with a
/// destructor, which a jump would skip.
bool decode(std::string_view bytes, const ImageHeader& header, Bgr* pixels) {
  jpeg_decompress_struct info{};
  ErrorManager errors{};
  jpeg_progress_mgr progress{};
  progress.progress_monitor = leave_on_many_scans;
  info.err = silent_errors(errors);
  if (setjmp(errors.leave) != 0) {  // NOLINT: libjpeg's way
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  info.progress = &progress;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  info.out_color_space = JCS_EXT_BGR;
  jpeg_start_decompress(&info);
  const auto width = static_cast<JDIMENSION>(header.width_px);
  bool good = info.output_width == width && info.output_components == 3 &&
              info.output_height == static_cast<JDIMENSION>(header.height_px);
  while (good && info.output_scanline < info.output_height) {
    JSAMPROW row = pixels[static_cast<std::size_t>(info.output_scanline) * width].data();
    jpeg_read_scanlines(&info, &row, 1);
  }
  good = good && jpeg_finish_decompress(&info) == TRUE;
  jpeg_destroy_decompress(&info);
  return good;
}

/// A buffer that libjpeg allocates and grows.
struct JpegBytes {
  unsigned char* data = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): libjpeg's type
};

/// False if libjpeg gives up; holds nothing with a destructor.
bool encode(const ColourImage& image, int quality, JpegBytes& out) {
  jpeg_compress_struct info{};
  ErrorManager errors{};
  info.err = silent_errors(errors);
  if (setjmp(errors.leave) != 0) {  // NOLINT: libjpeg's way
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &out.data, &out.size);
  info.image_width = static_cast<JDIMENSION>(image.width());
  info.image_height = static_cast<JDIMENSION>(image.height());
  info.input_components = 3;
  info.in_color_space = JCS_EXT_BGR;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    const Bgr* const pixels = image.row(static_cast<int>(info.next_scanline));
    auto* row = const_cast<JSAMPROW>(pixels->data());  // NOLINT(*-const-cast): only read
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

}  // namespace

Result<std::vector<Bgr>> decode_jpeg(std::string_view bytes, const ImageHeader& header) {
  if (header.channels != 1 && header.channels != 3) {
    return Error{"is a CMYK JPEG; convert it to RGB"};
  }
  std::vector<Bgr> pixels(static_cast<std::size_t>(header.width_px) * header.height_px);
  if (!decode(bytes, header, pixels.data())) return Error{"is damaged; copy or download it again"};
  return pixels;
}

Result<std::string> encode_jpeg(const ColourImage& image, int quality) {
  JpegBytes out;
  const bool good = encode(image, quality, out);
  const std::unique_ptr<unsigned char, decltype(&std::free)> owner(out.data, &std::free);
  if (!good) return Error{"cannot be encoded as JPEG"};
  return std::string(reinterpret_cast<const char*>(out.data), out.size);
}

}  // namespace ydd
