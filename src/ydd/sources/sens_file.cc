// SPDX-License-Identifier: Apache-2.0
//
// ScanNet's .sens, version 4 (https://github.com/ScanNet/ScanNet, SensReader): a header with both
// cameras and the number of frames, then for each frame T_world_camera (infinite where it is
// unknown), two stamps in microseconds, a JPEG or PNG and depth, packed by zlib. Depth is
// registered to colour but smaller: colour is brought to its size, as of the exports
// (scannet_folder.cc).
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "ydd/bags/byte_source.h"
#include "ydd/base/log.h"
#include "ydd/dataset/picture_files.h"
#include "ydd/image/decode.h"
#include "ydd/image/resize.h"
#include "ydd/sources/frame_numbers.h"
#include "ydd/sources/layout.h"
#include "ydd/sources/pose_files.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMatrix = 64;          // bytes of one
constexpr std::uint32_t kLargestSide = 16384;  // px
constexpr std::uint32_t kZlibDepth = 1;        // how depth is packed; 0: not at all

/// Takes the numbers of the file one after the other; `ok` until one is not there.
class SensReader {
 public:
  explicit SensReader(const bags::BagFile& file) : bytes_(file), size_(file.size()) {}
  bool ok() const { return ok_; }
  std::uint64_t offset() const { return offset_; }
  std::uint64_t number(std::uint64_t size) { return bags::little_endian(take(size)); }
  float real() { return std::bit_cast<float>(static_cast<std::uint32_t>(number(4))); }
  Eigen::Matrix4d matrix() {
    Eigen::Matrix4d out;
    for (int i = 0; i < 16; ++i) out(i / 4, i % 4) = static_cast<double>(real());
    return out;
  }
  void skip(std::uint64_t size) {
    ok_ = ok_ && size <= size_ - offset_;
    if (ok_) offset_ += size;
  }

 private:
  std::string_view take(std::uint64_t size) {
    const auto there = ok_ ? bytes_.at(offset_, size) : std::nullopt;
    ok_ = there.has_value();
    offset_ += ok_ ? size : 0;
    return there.value_or(std::string_view());
  }
  bags::ByteSource bytes_;
  std::uint64_t size_;
  std::uint64_t offset_ = 0;
  bool ok_ = true;
};

struct SensHeader {
  Eigen::Matrix4d K_colour, K_depth;
  std::uint32_t depth_coding = 0;
  std::uint32_t width_px = 0, height_px = 0;  ///< of depth
  double depth_scale = 0;
  std::uint64_t frames = 0;
};

struct SensFrame {
  Eigen::Matrix4d T_world_camera;
  Timestamp colour_stamp, depth_stamp;
  std::uint64_t colour = 0, colour_size = 0, depth = 0, depth_size = 0;
};

Result<SensHeader> read_sens_header(SensReader& reader, const fs::path& file) {
  SensHeader out;
  if (reader.number(4) != 4) return Error{file.string() + ": is no .sens file of version 4"};
  reader.skip(reader.number(8));  // name of the sensor
  out.K_colour = reader.matrix();
  reader.skip(kMatrix);
  out.K_depth = reader.matrix();
  reader.skip(kMatrix + 4);  // and how colour is packed: the pictures tell
  out.depth_coding = static_cast<std::uint32_t>(reader.number(4));
  reader.skip(8);  // size of colour
  out.width_px = static_cast<std::uint32_t>(reader.number(4));
  out.height_px = static_cast<std::uint32_t>(reader.number(4));
  out.depth_scale = static_cast<double>(reader.real());
  out.frames = reader.number(8);
  const bool sane = out.width_px > 0 && out.height_px > 0 && out.width_px <= kLargestSide &&
                    out.height_px <= kLargestSide &&
                    2 * std::uint64_t{out.width_px} * out.height_px <= bags::kLargestPiece &&
                    out.depth_scale >= 1 && out.depth_scale <= 1e6;
  if (!reader.ok() || !sane) return Error{file.string() + ": the header is damaged or cut off"};
  if (out.depth_coding > kZlibDepth) {
    return Error{fmt::format("{}: depth is packed in a way that is not read ({}); zlib is",
                             file.string(), out.depth_coding)};
  }
  return out;
}

std::vector<SensFrame> read_sens_frames(SensReader& reader, std::uint64_t most) {
  std::vector<SensFrame> out;
  for (std::uint64_t i = 0; i < most; ++i) {
    SensFrame frame;
    frame.T_world_camera = reader.matrix();
    constexpr std::uint64_t kLatest_us = static_cast<std::uint64_t>(kLatestStamp_s) * 1'000'000;
    for (Timestamp* const stamp : {&frame.colour_stamp, &frame.depth_stamp}) {
      stamp->ns = static_cast<std::int64_t>(std::min(reader.number(8), kLatest_us)) * 1000;
    }
    frame.colour_size = reader.number(8);
    frame.depth_size = reader.number(8);
    frame.colour = reader.offset();
    reader.skip(frame.colour_size);
    frame.depth = reader.offset();
    reader.skip(frame.depth_size);
    if (!reader.ok()) break;
    out.push_back(frame);
  }
  return out;
}

class SensPictures : public PictureStore {
 public:
  SensPictures(bags::BagFile file, SensHeader header, std::vector<SensFrame> frames)
      : file_(std::move(file)), header_(std::move(header)), frames_(std::move(frames)) {}

  Result<ColourPicture> colour(std::size_t i) const override {
    const SensFrame& frame = frames_.at(i);
    std::optional<std::string> bytes = file_.read(frame.colour, frame.colour_size);
    if (!bytes) return Error{name_of(i) + ": cannot be read"};
    Result<ColourPicture> picture = colour_picture(name_of(i), *std::move(bytes));
    if (!picture) return picture;
    const int width = static_cast<int>(header_.width_px),
              height = static_cast<int>(header_.height_px);
    if (picture->width_px == width && picture->height_px == height) return picture;
    return ColourPicture{picture->name, width, height,
                         [decode = picture->decode, width, height]() -> Result<ColourImage> {
                           const Result<ColourImage> image = decode();
                           if (!image) return image.error();
                           return resized(*image, width, height);
                         }};
  }

  Result<DepthPicture> depth(std::size_t i) const override {
    const SensFrame& frame = frames_.at(i);
    std::optional<std::string> read = file_.read(frame.depth, frame.depth_size);
    if (!read) return Error{name_of(i) + ": cannot be read"};
    const auto bytes = std::make_shared<const std::string>(*std::move(read));
    const auto counts = [bytes, name = name_of(i), header = header_] {
      return counts_of(*bytes, header, name);
    };
    DepthPicture out{name_of(i),
                     static_cast<int>(header_.width_px),
                     static_cast<int>(header_.height_px),
                     {},
                     counts};
    out.metres = [counts](const Camera& camera) -> Result<DepthImage> {
      const Result<RawDepthImage> raw = counts();
      if (!raw) return raw.error();
      return to_metres(*raw, camera);
    };
    return out;
  }

  std::string name_of(std::size_t i) const {
    return fmt::format("{}, frame {}", file_.path().string(), i);
  }

 private:
  static Result<RawDepthImage> counts_of(const std::string& bytes, const SensHeader& header,
                                         const std::string& name) {
    const std::size_t n = std::size_t{header.width_px} * header.height_px;
    std::string raw = bytes;
    if (header.depth_coding == kZlibDepth) {
      raw.assign(2 * n, '\0');
      auto size = static_cast<uLongf>(raw.size());
      const auto* const from = reinterpret_cast<const Bytef*>(bytes.data());
      const int code = uncompress(reinterpret_cast<Bytef*>(raw.data()), &size, from, bytes.size());
      if (code != Z_OK) raw.clear();
      raw.resize(size);
    }
    if (raw.size() != 2 * n) return Error{name + ": the depth is damaged"};
    std::vector<std::uint16_t> counts(n);
    for (std::size_t k = 0; k < n; ++k) {
      counts[k] =
          static_cast<std::uint16_t>(bags::little_endian(std::string_view(raw).substr(2 * k, 2)));
    }
    return RawDepthImage(static_cast<int>(header.width_px), static_cast<int>(header.height_px),
                         std::move(counts));
  }

  bags::BagFile file_;
  SensHeader header_;
  std::vector<SensFrame> frames_;
};

Result<Camera> sens_camera(const SensHeader& header, const fs::path& file) {
  Camera camera{.name = "scannet"};
  camera.width_px = static_cast<int>(header.width_px);
  camera.height_px = static_cast<int>(header.height_px);
  camera.fx_px = header.K_depth(0, 0), camera.cx_px = header.K_depth(0, 2);
  camera.fy_px = header.K_depth(1, 1), camera.cy_px = header.K_depth(1, 2);
  camera.depth_scale = header.depth_scale;
  if (auto r = check_camera(camera); !r) {
    return Error{fmt::format("{}: {}", file.string(), r.error().message)};
  }
  return camera;
}

Result<StampedPoses> sens_poses(const std::vector<SensFrame>& frames, const fs::path& file) {
  StampedPoses poses;
  for (const SensFrame& frame : frames) {
    const auto pose = motion_of(frame.T_world_camera, file.string());
    if (!pose) return pose.error();
    if (*pose) poses.push_back({frame.colour_stamp, **pose});
  }
  if (poses.empty()) return Error{file.string() + ": holds no pose"};
  return poses;
}

/// Some recorders set no stamps.
void settle_stamps(std::vector<SensFrame>& frames, const fs::path& file) {
  bool increasing = true;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    increasing = increasing && frames[i - 1].colour_stamp < frames[i].colour_stamp;
  }
  if (increasing) return;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].colour_stamp = frames[i].depth_stamp = frame_stamp(static_cast<std::int64_t>(i));
  }
  tell_frame_rate(file);
}

Result<Recording> open_sens(const fs::path& path, const SequenceOptions&) {
  Result<bags::BagFile> file = bags::BagFile::open(path);
  if (!file) return file.error();
  SensReader reader(*file);
  const Result<SensHeader> header = read_sens_header(reader, path);
  if (!header) return header.error();
  std::vector<SensFrame> frames = read_sens_frames(reader, header->frames);
  if (frames.empty()) return Error{path.string() + ": holds no whole frame"};
  if (frames.size() < header->frames) {
    log::warning("{}: is cut off; read up to there: {} of {} frames", path.string(), frames.size(),
                 header->frames);
  }
  settle_stamps(frames, path);
  Recording out;
  out.pairs.emplace();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string name = fmt::format("{}, frame {}", path.string(), i);
    out.pairs->push_back({i, i});
    out.colour.push_back({frames[i].colour_stamp, name});
    out.depth.push_back({frames[i].depth_stamp, name});
  }
  out.camera = sens_camera(*header, path);
  out.depth_scale = header->depth_scale;
  out.groundtruth = GroundTruth{path, false, [frames, path] { return sens_poses(frames, path); }};
  out.pictures = std::make_shared<const SensPictures>(*std::move(file), *header, std::move(frames));
  return out;
}

bool looks_like_sens(const fs::path& path) {
  std::error_code failure;
  return path.extension() == ".sens" && fs::is_regular_file(path, failure);
}

}  // namespace

Layout sens_layout() { return {"sens", "file .sens: ScanNet", looks_like_sens, open_sens}; }

}  // namespace ydd::sources
