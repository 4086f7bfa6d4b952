// SPDX-License-Identifier: Apache-2.0
//
// Bags of ROS 1 and 2 as recordings: sensor_msgs Image, CompressedImage and CameraInfo. Stamps are
// those of the headers, which say when a picture was taken; when a message was received is used
// only where they say nothing.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "ydd/bags/bag.h"
#include "ydd/base/log.h"
#include "ydd/base/timing.h"
#include "ydd/messages/ros_pictures.h"
#include "ydd/sources/bag_motion.h"
#include "ydd/sources/bag_topics.h"
#include "ydd/sources/camera_note.h"
#include "ydd/sources/layout.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

/// ROS counts depth in millimetres where it counts (REP 118).
constexpr double kRosDepthScale = 1000;

/// The messages of a topic in the order of their stamps, and what messages call them.
struct Stream {
  std::vector<BagMessage> messages;
  std::vector<PictureEntry> entries;
};

Result<StoredMessage> read_message(const Bag& bag, const BagMessage& message, std::string name) {
  const BagTopic& topic = bag.topics().at(message.topic);
  Result<std::string> bytes = bag.read(message);
  if (!bytes) return bytes.error();
  return StoredMessage{std::move(name), message_kind(topic.type), topic.wire,
                       std::make_shared<const std::string>(*std::move(bytes))};
}

bool holds_picture(MessageKind kind) {
  return kind == MessageKind::image || kind == MessageKind::compressed_image;
}

/// What there is, each topic of pictures with the nature of its first message.
std::vector<TopicSeen> topics_seen(const Bag& bag) {
  std::vector<TopicSeen> out;
  for (const BagTopic& topic : bag.topics()) {
    out.push_back({topic.name, topic.type, message_kind(topic.type), {}, topic.messages});
  }
  std::vector<bool> looked(out.size());
  for (const BagMessage& message : bag.messages()) {
    TopicSeen& topic = out[message.topic];
    if (looked[message.topic] || !holds_picture(topic.kind)) continue;
    looked[message.topic] = true;
    if (const auto first = read_message(bag, message, topic.name)) topic.nature = nature_of(*first);
  }
  return out;
}

/// Median of how much later messages came than their headers say.
double median_delay_s(const std::vector<BagMessage>& messages) {
  std::vector<double> delays_s;
  for (const BagMessage& message : messages) {
    delays_s.push_back(seconds_between(message.stamp, message.received));
  }
  return statistics_of(std::move(delays_s)).median;
}

/// Headers that say nothing leave the times of receiving, with a warning.
void judge_stamps(std::vector<BagMessage>& messages, const std::string& what) {
  const bool none = std::all_of(messages.begin(), messages.end(), [&](const BagMessage& message) {
    return message.stamp == messages.front().stamp;
  });
  if (!none || messages.size() < 2) return;
  log::warning(
      "{}: all headers have the stamp {}; the times at which messages were received are used "
      "instead",
      what, format_timestamp(messages.front().stamp));
  for (BagMessage& message : messages) message.stamp = message.received;
}

void warn_of_clocks(const std::vector<BagMessage>& messages, const fs::path& file) {
  constexpr double kFar_s = 10;
  const double delay_s = median_delay_s(messages);
  if (std::abs(delay_s) < kFar_s) return;
  log::warning(
      "{}: pictures were received {:.0f} s {} than their headers say; the clocks differ, and the "
      "headers' stamps are used",
      file.string(), std::abs(delay_s), delay_s > 0 ? "later" : "earlier");
}

Stream stream_of(const Bag& bag, const fs::path& file, std::size_t topic) {
  const std::string what = fmt::format("{}: {}", file.string(), bag.topics()[topic].name);
  Stream out;
  for (const BagMessage& message : bag.messages()) {
    if (message.topic == topic) out.messages.push_back(message);
  }
  judge_stamps(out.messages, what);
  std::stable_sort(out.messages.begin(), out.messages.end(),
                   [](const BagMessage& a, const BagMessage& b) { return a.stamp < b.stamp; });
  const std::size_t all = out.messages.size();
  out.messages.erase(
      std::unique(out.messages.begin(), out.messages.end(),
                  [](const BagMessage& a, const BagMessage& b) { return a.stamp == b.stamp; }),
      out.messages.end());
  if (out.messages.size() < all) {
    log::warning("{}: {} of {} messages have the stamp of another one, and are left out", what,
                 all - out.messages.size(), all);
  }
  for (const BagMessage& message : out.messages) {
    out.entries.push_back({message.stamp, fmt::format("{}, message {}", what, out.entries.size())});
  }
  return out;
}

class BagPictures : public PictureStore {
 public:
  BagPictures(std::shared_ptr<const Bag> bag, Stream colour, Stream depth)
      : bag_(std::move(bag)), colour_(std::move(colour)), depth_(std::move(depth)) {}

  Result<ColourPicture> colour(std::size_t i) const override {
    const auto message = read_message(*bag_, colour_.messages.at(i), colour_.entries.at(i).name);
    if (!message) return message.error();
    return colour_of(*message);
  }
  Result<DepthPicture> depth(std::size_t i) const override {
    const auto message = read_message(*bag_, depth_.messages.at(i), depth_.entries.at(i).name);
    if (!message) return message.error();
    return depth_of(*message);
  }

 private:
  std::shared_ptr<const Bag> bag_;
  Stream colour_, depth_;
};

/// The first CameraInfo of the topic.
Result<CameraInfoMessage> first_info(const Bag& bag, std::size_t topic) {
  const auto first =
      std::find_if(bag.messages().begin(), bag.messages().end(),
                   [&](const BagMessage& message) { return message.topic == topic; });
  if (first == bag.messages().end()) return Error{"no message"};
  const auto message = read_message(bag, *first, bag.topics()[topic].name);
  if (!message) return message.error();
  const auto info = read_camera_info(*message->bytes, message->wire);
  if (!info) return Error{bag.topics()[topic].name + ": the message is damaged"};
  return *info;
}

/// Pictures a second.
double rate_hz(const std::vector<PictureEntry>& pictures, double otherwise) {
  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    gaps_s.push_back(seconds_between(pictures[i - 1].stamp, pictures[i].stamp));
  }
  const double gap_s = gaps_s.empty() ? 0 : statistics_of(std::move(gaps_s)).median;
  return gap_s > 0.001 && gap_s < 10 ? std::round(10 / gap_s) / 10 : otherwise;
}

/// Depth that is seen by another lens than colour is not registered to it.
void warn_of_other_lens(const Bag& bag, const fs::path& file, const std::vector<TopicSeen>& topics,
                        std::size_t depth, const Camera& camera) {
  if (says_registered(topics[depth].name)) return;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (topics[i].name != camera_info_of(topics[depth].name) || topics[i].messages == 0) continue;
    const auto info = first_info(bag, i);
    if (!info || !(info->k[0] > 0)) return;
    if (std::abs(info->k[0] - camera.fx_px) < 0.02 * camera.fx_px) return;
    log::warning(
        "{}: {} is seen with fx {:.1f} but colour with {:.1f}: depth must be registered to "
        "colour; name the topic of registered depth with --topic-depth",
        file.string(), topics[depth].name, info->k[0], camera.fx_px);
    return;
  }
}

/// The camera that a recording of ours keeps; nothing: it is none.
std::optional<Camera> noted_camera(const Bag& bag, const fs::path& file) {
  const auto note = bag.notes().find(kCameraNote);
  if (note == bag.notes().end()) return std::nullopt;
  const Result<Camera> camera = camera_of_note(note->second);
  if (camera) return *camera;
  log::warning("{}: {}; CameraInfo counts", file.string(), camera.error().message);
  return std::nullopt;
}

Result<Camera> bag_camera(const Bag& bag, const std::vector<TopicSeen>& topics, std::size_t colour,
                          std::size_t depth, const std::string& asked) {
  const Result<std::size_t> topic = choose_camera_info(topics, colour, depth, asked);
  if (!topic) return topic.error();
  const Result<CameraInfoMessage> info = first_info(bag, *topic);
  if (!info) return info.error();
  Result<Camera> camera = camera_of(*info, says_rectified(topics[colour].name));
  if (!camera) return Error{fmt::format("{} {}", topics[*topic].name, camera.error().message)};
  return camera;
}

/// A stream that is cut off before its first message has no topic to choose.
Error nothing_in(const Bag& bag, const fs::path& file, const Error& error) {
  const std::string cut = bag.incomplete().empty() ? "" : bag.incomplete() + ", and holds ";
  return Error{fmt::format("{}: {}{}", file.string(), cut, error.message)};
}

Result<Recording> open_bag_recording(const fs::path& file, const SequenceOptions& options) {
  const Result<std::shared_ptr<const Bag>> opened = open_bag(file);
  if (!opened) return opened.error();
  const Bag& bag = **opened;
  const std::vector<TopicSeen> topics = topics_seen(bag);
  const auto colour =
      choose_topic(topics, PictureUse::colour, options.topic_colour, "--topic-colour");
  if (!colour) return nothing_in(bag, file, colour.error());
  const auto depth = choose_topic(topics, PictureUse::depth, options.topic_depth, "--topic-depth");
  if (!depth) return nothing_in(bag, file, depth.error());
  Stream colours = stream_of(bag, file, *colour), depths = stream_of(bag, file, *depth);
  if (!bag.incomplete().empty()) {
    log::warning("{}: {}; read up to there: {} colour and {} depth pictures", file.string(),
                 bag.incomplete(), colours.entries.size(), depths.entries.size());
  }
  warn_of_clocks(colours.messages, file);
  log::info("{}: colour {}, depth {}", file.string(), topics[*colour].name, topics[*depth].name);
  Recording recording;
  recording.colour = colours.entries;
  recording.depth = depths.entries;
  const auto noted = options.topic_camera_info.empty() ? noted_camera(bag, file) : std::nullopt;
  Result<Camera> camera =
      noted ? Result(*noted) : bag_camera(bag, topics, *colour, *depth, options.topic_camera_info);
  if (!noted && camera) {
    camera->fps = rate_hz(recording.colour, camera->fps);
    warn_of_other_lens(bag, file, topics, *depth, *camera);
  } else if (!camera) {
    camera = Error{fmt::format("{}: {}", file.string(), camera.error().message)};
  }
  recording.camera = camera;
  recording.depth_is_laid = noted.has_value();
  if (topics[*depth].nature.encoding.find("32FC1") == std::string::npos) {
    recording.depth_scale = kRosDepthScale;
  }
  recording.motion = bag_motion(*opened, file);
  recording.pictures =
      std::make_shared<const BagPictures>(*opened, std::move(colours), std::move(depths));
  return recording;
}

}  // namespace

Layout bag_layout() {
  return {"bag", "bag of ROS 1 (.bag) or 2 (.db3, .mcap, or their folder)", is_bag,
          open_bag_recording};
}

}  // namespace ydd::sources
