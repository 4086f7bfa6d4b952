// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/messages/ros_pictures.h"

/// Which topics of a bag are colour, depth and the camera. Inside this room only.
namespace ydd::sources {

/// A topic with messages.
struct TopicSeen {
  std::string name;
  std::string type;
  MessageKind kind = MessageKind::other;
  PictureNature nature;  ///< of its first message, if it is of pictures
  std::size_t messages = 0;
};

/// Index of the topic of colour, or of depth: `asked` where it is not empty (also without the
/// "/compressed" at its end), else the one whose encoding and name say most that it is. One line
/// lists the candidates where there is none, or where several are as good; it names `option`.
Result<std::size_t> choose_topic(const std::vector<TopicSeen>& topics, PictureUse use,
                                 const std::string& asked, std::string_view option);

/// Index of the CameraInfo of the colour topic: `asked`, else that of its namespace, else that of
/// the depth topic's if depth is registered to colour, else the only one.
Result<std::size_t> choose_camera_info(const std::vector<TopicSeen>& topics, std::size_t colour,
                                       std::size_t depth, const std::string& asked);

/// Whether the name says that depth is registered to colour.
bool says_registered(const std::string& topic);

/// Whether the name says that the picture is free of distortion.
bool says_rectified(const std::string& topic);

/// The name of the CameraInfo that belongs to a topic of pictures: "/a/image/compressed" has
/// "/a/camera_info".
std::string camera_info_of(const std::string& topic);

}  // namespace ydd::sources
