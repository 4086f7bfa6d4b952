// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "support.h"
#include "ydd/bags/bag.h"
#include "ydd/messages/ros_pictures.h"

namespace ydd::fuzz {

/// Whatever a message says it is: pictures are decoded, cameras checked.
inline void read_as_anything(const StoredMessage& message) {
  const Camera camera;
  if (message.kind == MessageKind::camera_info) {
    const auto info = read_camera_info(*message.bytes, message.wire);
    if (!info) return;
    for (const bool rectified : {false, true}) {
      const Result<Camera> found = camera_of(*info, rectified);
      expect_one_line(found);
      if (found && !check_camera(*found)) broken("a camera that none can be");
    }
    return;
  }
  static_cast<void>(read_imu(*message.bytes, message.wire));
  static_cast<void>(read_odometry(*message.bytes, message.wire));
  static_cast<void>(nature_of(message));
  const Result<ColourPicture> colour = colour_of(message);
  expect_one_line(colour);
  if (colour) expect_one_line(colour->decode());
  const Result<DepthPicture> depth = depth_of(message);
  expect_one_line(depth);
  if (!depth) return;
  const Result<DepthImage> depth_m = depth->metres(camera);
  expect_one_line(depth_m);
  expect_one_line(depth->counts());
  if (!depth_m) return;
  for (int i = 0; i < depth_m->width() * depth_m->height(); ++i) {
    const float z = depth_m->data()[i];
    if (z != 0 && !camera.is_valid_depth(z)) broken("a depth beyond the camera's limits");
  }
}

/// A bag, all that it holds.
inline void read_bag(std::string_view input, const std::string& name) {
  const Result<std::shared_ptr<const Bag>> bag = open_bag(file_of(input, name));
  expect_one_line(bag);
  if (!bag) return;
  if ((*bag)->incomplete().find('\n') != std::string::npos) broken("not one line");
  constexpr std::size_t kMost = 8;
  for (std::size_t i = 0; i < std::min(kMost, (*bag)->messages().size()); ++i) {
    const BagMessage& message = (*bag)->messages()[i];
    const BagTopic& topic = (*bag)->topics().at(message.topic);
    Result<std::string> bytes = (*bag)->read(message);
    expect_one_line(bytes);
    if (!bytes) continue;
    read_as_anything({"a message", message_kind(topic.type), topic.wire,
                      std::make_shared<const std::string>(*std::move(bytes))});
  }
}

}  // namespace ydd::fuzz
