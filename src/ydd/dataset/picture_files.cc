// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/picture_files.h"

#include <algorithm>
#include <utility>

#include "ydd/base/files.h"
#include "ydd/image/decode.h"
#include "ydd/image/resize.h"

namespace ydd {
namespace {

std::vector<std::string> names_of(const std::vector<PictureEntry>& pictures) {
  std::vector<std::string> names;
  names.reserve(pictures.size());
  for (const PictureEntry& picture : pictures) names.push_back(picture.name);
  return names;
}

class PictureFiles : public PictureStore {
 public:
  PictureFiles(const Recording& recording, const PictureFileRules& rules)
      : colour_(names_of(recording.colour)), depth_(names_of(recording.depth)), rules_(rules) {}

  Result<ColourPicture> colour(std::size_t i) const override {
    Result<std::string> bytes = read_file(colour_.at(i));
    if (!bytes) return bytes.error();
    Result<ColourPicture> picture = colour_picture(colour_.at(i), *std::move(bytes));
    if (!picture || !rules_.colour_size_px) return picture;
    const auto [width_px, height_px] = *rules_.colour_size_px;
    if (picture->width_px == width_px && picture->height_px == height_px) return picture;
    return ColourPicture{
        picture->name, width_px, height_px,
        [decode = picture->decode, width = width_px, height = height_px]() -> Result<ColourImage> {
          const Result<ColourImage> image = decode();
          if (!image) return image.error();
          return resized(*image, width, height);
        }};
  }

  Result<DepthPicture> depth(std::size_t i) const override {
    Result<std::string> bytes = read_file(depth_.at(i));
    if (!bytes) return bytes.error();
    Result<DepthPicture> picture = depth_picture(depth_.at(i), *std::move(bytes));
    if (!picture || !rules_.no_reading_from) return picture;
    picture->metres = [metres = picture->metres,
                       most = *rules_.no_reading_from - 1](Camera camera) {
      camera.max_depth_m = std::min(camera.max_depth_m, most / camera.depth_scale);
      return metres(camera);
    };
    return picture;
  }

 private:
  std::vector<std::string> colour_, depth_;
  PictureFileRules rules_;
};

}  // namespace

std::shared_ptr<const PictureStore> picture_files(const Recording& recording,
                                                  const PictureFileRules& rules) {
  return std::make_shared<const PictureFiles>(recording, rules);
}

Result<ColourPicture> colour_picture(const std::string& name, std::string bytes) {
  Result<ImageFile> opened = open_colour(name, std::move(bytes));
  if (!opened) return opened.error();
  const auto file = std::make_shared<const ImageFile>(*std::move(opened));
  return ColourPicture{name, file->header.width_px, file->header.height_px,
                       [file] { return decode_colour(*file); }};
}

Result<DepthPicture> depth_picture(const std::string& name, std::string bytes) {
  Result<ImageFile> opened = open_depth(name, std::move(bytes));
  if (!opened) return opened.error();
  const auto file = std::make_shared<const ImageFile>(*std::move(opened));
  return DepthPicture{name, file->header.width_px, file->header.height_px,
                      [file](const Camera& camera) { return decode_depth(*file, camera); },
                      [file] { return decode_raw_depth(*file); }};
}

}  // namespace ydd
