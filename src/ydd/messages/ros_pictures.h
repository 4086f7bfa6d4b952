// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "ydd/base/result.h"
#include "ydd/dataset/recording.h"
#include "ydd/messages/ros_messages.h"

/// Messages as pictures and cameras.
namespace ydd {

/// A message as a bag holds it.
struct StoredMessage {
  std::string name;  ///< as errors call it
  MessageKind kind = MessageKind::other;
  Wire wire = Wire::ros1;
  std::shared_ptr<const std::string> bytes;
};

/// What a picture shows, told by its encoding.
enum class PictureUse { colour, grey, depth, neither };
/// What a message shows, and by which encoding.
struct PictureNature {
  PictureUse use = PictureUse::neither;
  std::string encoding;  ///< as the message says it; empty: it is damaged
};
PictureNature nature_of(const StoredMessage& message);

/// rgb8, bgr8, rgba8, bgra8, mono8, 8UC1, 8UC3, 8UC4; of a compressed image JPEG and PNG.
Result<ColourPicture> colour_of(const StoredMessage& message);

/// 16UC1 and mono16 (counts by the camera's depth scale; ROS means millimetres, REP 118), 32FC1
/// (metres; infinite and NaN are no reading); of a compressed image "compressedDepth" of either: 12
/// bytes (a format and two parameters), then a PNG of 16 bits. With 32FC1 that holds
/// a / depth + b of these parameters a and b.
Result<DepthPicture> depth_of(const StoredMessage& message);

/// The same of a picture that is not compressed, at once. One line of failure says what it is and
/// what is read.
Result<ColourImage> colour_of(const ImageMessage& image);

/// Metres; counts are millimetres whatever the camera's scale. Readings outside the camera's limits
/// become 0.
Result<DepthImage> depth_of(const ImageMessage& image, const Camera& camera);

/// The same of a picture that is compressed, as StoredMessage is read.
Result<ColourImage> colour_of(const CompressedImageMessage& image);
Result<DepthImage> depth_of(const CompressedImageMessage& image, const Camera& camera);

/// A camera of a depth scale of 1000. `rectified`: of pictures that have no distortion any more (P
/// instead of K and D). Fails for lenses that are not pinhole with k1, k2, p1, p2, k3, and for a
/// camera that was never calibrated (all 0).
Result<Camera> camera_of(const CameraInfoMessage& info, bool rectified);

}  // namespace ydd
