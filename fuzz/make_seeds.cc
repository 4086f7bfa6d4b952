// SPDX-License-Identifier: Apache-2.0
//
// Writes the seeds that nobody writes by hand (networks, pictures, maps) into FOLDER/<target>/: to
// be run again when a format changes.
#include <cstdio>

#include "support.h"
#include "ydd/bags/bags_testing.h"
#include "ydd/image/decode.h"
#include "ydd/image/jpeg_codec.h"
#include "ydd/inference/tiny_onnx_testing.h"
#include "ydd/map/world_testing.h"
#include "ydd/map_files/database.h"
#include "ydd/map_files/map_blobs.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_schema.h"
#include "ydd/messages/wire_testing.h"

namespace ydd::fuzz {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& content) {
  fs::create_directories(file.parent_path());
  testing_onnx::write(file, content);
}

void write_networks(const fs::path& folder) {
  write(folder / "spotter.onnx", testing_onnx::colour_spotter_model());
  write(folder / "relu.onnx", testing_onnx::single_operator_model("Relu"));
  testing_onnx::GraphWriter g;
  const std::string stem = g.silu(g.convolution("images", 3, 4, 3, 2));
  const std::string sum = g.node("Add", {stem, g.node("Relu", {g.convolution(stem, 4, 4, 1)})});
  write(folder / "all_layers.onnx",
        g.finish({g.concat({g.twice(g.convolution(g.pool(sum, 3), 4, 4, 3, 2, 4)), sum})}));
}

void write_pictures(const fs::path& root) {
  std::vector<Bgr> pixels;
  for (int i = 0; i < 12 * 9; ++i) {
    const auto v = static_cast<std::uint8_t>(7 * i);
    pixels.push_back({v, static_cast<std::uint8_t>(v ^ 85U), static_cast<std::uint8_t>(255 - v)});
  }
  const ColourImage colour(12, 9, pixels);
  write(root / "jpeg/colour.jpg", encode_jpeg(colour, 80).value());
  fs::create_directories(root / "png");
  const RawDepthImage depth(5, 4, std::vector<std::uint16_t>(20, 5000));
  const bool done = write_png(root / "png/colour.png", colour).ok() &&
                    write_png(root / "png/grey.png", to_grey(colour)).ok() &&
                    write_png(root / "png/depth.png", depth).ok();
  if (!done) throw std::runtime_error("pictures cannot be written");
  // As the target png_pixels takes them: size, bits, kind, interlacing, palette, rows with filters.
  const auto pixels_of = [&](const std::string& name, const std::string& head, std::size_t rows) {
    std::string bytes = head;
    for (std::size_t i = 0; i < rows; ++i) bytes += static_cast<char>(i % 5);
    write(root / "png_pixels" / name, bytes);
  };
  const std::string none(1, '\0');
  pixels_of("grey8", "\x07\x06\x08" + none + none + none, 48);
  pixels_of("grey16", "\x07\x06\x10" + none + none + none, 90);
  pixels_of("colour8", "\x07\x06\x08\x02" + none + none, 132);
  pixels_of("grey1", "\x07\x06\x01" + none + none + none, 12);
  pixels_of("palette4", "\x07\x06\x04\x03" + none + "\x0f" + "abcdefghijklmno", 30);
  pixels_of("interlaced", "\x07\x06\x08" + none + "\x01" + none, 54);
}

/// Three keyframes that see a few points.
Atlas small_atlas() {
  const auto world = testing_world::make_world(12, 1);
  std::vector<testing_world::View> views;
  for (int i = 0; i < 3; ++i) {
    views.push_back(testing_world::look(world, testing_world::hand_held(0.2 * i)));
  }
  auto built = testing_world::build_map(world, views, 3);
  built.atlas.add_loop(built.keyframes[0], built.keyframes[2]);
  built.atlas.cull_keyframe(built.keyframes[1]);
  return std::move(built.atlas);
}

std::string as_number(std::uint64_t value, unsigned bytes) {
  std::string out;
  for (unsigned i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8U * i));
  return out;
}

/// A cell as the target map_rows takes it.
std::string cell(const map_format::Value& value) {
  if (const auto* const number = std::get_if<std::int64_t>(&value)) {
    const auto bits = static_cast<std::uint64_t>(*number);
    if (bits < 128) return as_number(bits, 1);
    if (bits <= UINT32_MAX) return "\x80" + as_number(bits, 4);
    return "\x90" + as_number(bits >> 32U, 4) + as_number(bits, 4);
  }
  const auto& bytes = std::get<std::string>(value);
  const std::string size =
      bytes.size() < 103 ? as_number(152 + bytes.size(), 1) : "\xff" + as_number(bytes.size(), 2);
  return size + bytes;
}

void write_maps(const fs::path& root) {
  fs::create_directories(root / "map_file");
  const fs::path file = root / "map_file/small.map";
  fs::remove(file);
  const auto save = [&](const Atlas& atlas) {
    const auto saved = save_map(atlas, file);
    if (!saved) throw std::runtime_error(saved.error().message);
  };
  save(small_atlas());
  save(load_map(file).value());  // with the words that a load makes
  map_format::Database database(file, map_format::Database::Mode::read);
  std::string rows;
  const auto add = [&](const map_format::Row& row, std::uint64_t) {
    for (const map_format::Value& value : row.values) rows += cell(value);
  };
  database.for_each(map_format::kAtlas, add);
  for (std::size_t which = 0; which < std::size(map_format::kContent); ++which) {
    database.for_each(*map_format::kContent[which],
                      [&](const map_format::Row& row, std::uint64_t checksum) {
                        rows += as_number(which, 1);
                        rows += cell(std::int64_t{row.key});
                        add(row, checksum);
                      });
  }
  write(root / "map_rows/small", rows);
}

void write_blobs(const fs::path& folder) {
  const Atlas atlas = small_atlas();
  const KeyFrame& keyframe = *atlas.keyframes().find(atlas.keyframes().ids().front());
  map_format::PointBlock points;
  for (const MapPointId id : atlas.points().ids()) points.add(id, *atlas.points().find(id));
  const std::string blobs[] = {map_format::encode_pose(keyframe.T_world_camera),
                               map_format::encode_camera(atlas.camera()),
                               map_format::encode_scales(atlas.scales()),
                               map_format::encode_features(keyframe.features()),
                               map_format::encode_covisible(keyframe.covisible),
                               map_format::encode_ids(keyframe.loops),
                               points.take(),
                               map_format::encode_bag({{3, 70, 9000}, {0.25F, 0.25F, 0.5F}}),
                               map_format::encode_blocks_of(keyframe.points)};
  for (std::size_t kind = 0; kind < std::size(blobs); ++kind) {
    write(folder / std::to_string(kind), as_number(kind, 1) + blobs[kind]);
  }
}

/// A picture of each kind and a camera.
bags::WrittenMessages bag_messages(Wire wire) {
  const std::string package = wire == Wire::ros1 ? "sensor_msgs/" : "sensor_msgs/msg/";
  const Timestamp t{5'000'000'000};
  const std::string rows(48, '\7');
  return {{"/rgb/image", package + "Image", t, image_message(wire, t, 4, 4, "rgb8", 12, rows)},
          {"/depth/image", package + "Image", t,
           image_message(wire, t, 4, 4, "16UC1", 8, rows.substr(0, 32))},
          {"/metres/image", package + "Image", t,
           image_message(wire, t, 4, 2, "32FC1", 16, rows.substr(0, 32))},
          {"/packed/compressedDepth", package + "CompressedImage", t,
           compressed_message(wire, t, "32FC1; compressedDepth png", std::string(12, '\0') + rows)},
          {"/rgb/camera_info", package + "CameraInfo", t,
           camera_info_message(wire, t, 640, 480, 525, 525, 319, 239, {0.1, 0, 0, 0, 0})}};
}

void write_bags(const fs::path& root) {
  const bags::WrittenMessages ros1 = bag_messages(Wire::ros1), cdr = bag_messages(Wire::cdr);
  write(root / "bag_ros1/plain.bag", bags::ros1_bag(ros1, "none"));
  write(root / "bag_ros1/lz4.bag", bags::ros1_bag(ros1, "lz4", 5));
  write(root / "bag_mcap/plain.mcap", bags::mcap_bag(cdr, ""));
  write(root / "bag_mcap/single.mcap", bags::mcap_bag(cdr, "no chunks"));
  write(root / "bag_mcap/zstd.mcap", bags::mcap_bag(cdr, "zstd", "cdr", 5));
  fs::create_directories(root / "bag_sqlite");
  fs::remove(root / "bag_sqlite/small.db3");
  bags::write_sqlite_bag(root / "bag_sqlite/small.db3", cdr);
  for (const auto& [messages, wire] : {std::pair{&ros1, 0}, {&cdr, 0x81}}) {
    for (const bags::WrittenMessage& m : *messages) {
      const int kind = m.type.ends_with("CompressedImage") ? 1 : m.type.ends_with("Info") ? 2 : 0;
      const int choice = wire == 0 ? kind : 0x81 + kind;  // 0x81 % 3 == 0
      write(root / "ros_messages" / (std::to_string(choice) + m.topic.substr(1, 3)),
            as_number(static_cast<std::size_t>(choice), 1) + m.bytes);
    }
  }
}

}  // namespace
}  // namespace ydd::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: ydd_make_fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  const std::filesystem::path root = argv[1];
  ydd::fuzz::write_networks(root / "onnx");
  ydd::fuzz::write_pictures(root);
  ydd::fuzz::write_maps(root);
  ydd::fuzz::write_blobs(root / "map_blobs");
  ydd::fuzz::write_bags(root);
  return 0;
}
