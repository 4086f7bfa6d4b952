// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/bag_topics.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ydd::sources {
namespace {

bool contains_any(std::string name, std::initializer_list<std::string_view> parts) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(parts.begin(), parts.end(),
                     [&](std::string_view part) { return name.find(part) != std::string::npos; });
}

bool is_picture(const TopicSeen& topic) {
  return topic.kind == MessageKind::image || topic.kind == MessageKind::compressed_image;
}

/// Without the name of the transport.
std::string base_of(const TopicSeen& topic) {
  for (const std::string_view transport : {"/compressedDepth", "/compressed"}) {
    if (topic.kind == MessageKind::compressed_image && topic.name.ends_with(transport)) {
      return topic.name.substr(0, topic.name.size() - transport.size());
    }
  }
  return topic.name;
}

bool can_be(const TopicSeen& topic, PictureUse use) {
  if (!is_picture(topic) || topic.messages == 0) return false;
  if (use == PictureUse::depth) return topic.nature.use == PictureUse::depth;
  return topic.nature.use == PictureUse::colour || topic.nature.use == PictureUse::grey;
}

/// How much speaks for it. Raw pictures are better than the same ones packed with a loss.
int score(const TopicSeen& topic, PictureUse use) {
  const std::string& name = topic.name;
  int out = topic.kind == MessageKind::image ? 1 : 0;
  if (contains_any(name, {"debug", "mask", "segment", "annotat", "detect"})) out -= 8;
  if (use == PictureUse::depth) {
    if (says_registered(name)) out += 8;
    if (contains_any(name, {"depth"})) out += 4;
    return out;
  }
  if (contains_any(name, {"color", "colour", "rgb"})) out += 4;
  if (topic.nature.use == PictureUse::colour) out += 2;
  if (contains_any(name, {"depth", "infra", "/ir/", "fisheye", "thermal", "left", "right"}))
    out -= 4;
  return out;
}

std::string described(const TopicSeen& topic) {
  const std::string what = is_picture(topic) ? topic.nature.encoding : topic.type;
  return fmt::format("{} ({}, {} messages)", topic.name, what, topic.messages);
}

/// Those for which `pick` holds, as a list for an error; what does not fit is counted.
template <class Pick>
std::string listed(const std::vector<TopicSeen>& topics, Pick pick) {
  constexpr std::size_t kMost = 12;
  std::vector<std::string> names;
  for (const TopicSeen& topic : topics) {
    if (pick(topic)) names.push_back(described(topic));
  }
  if (names.empty()) return "none";
  const std::size_t more = names.size() > kMost ? names.size() - kMost : 0;
  names.resize(names.size() - more);
  const std::string end = more > 0 ? fmt::format(" and {} more", more) : "";
  return fmt::format("{}{}", fmt::join(names, ", "), end);
}

const char* name_of(PictureUse use) { return use == PictureUse::depth ? "depth" : "colour"; }

Result<std::size_t> asked_topic(const std::vector<TopicSeen>& topics, const std::string& asked,
                                std::string_view option) {
  for (const bool exactly : {true, false}) {
    for (std::size_t i = 0; i < topics.size(); ++i) {
      const std::string name = exactly ? topics[i].name : base_of(topics[i]);
      if (name == asked && is_picture(topics[i]) && topics[i].messages > 0) return i;
    }
  }
  return Error{fmt::format("{}: no topic '{}' with pictures; there are: {}", option, asked,
                           listed(topics, is_picture))};
}

}  // namespace

bool says_registered(const std::string& topic) {
  return contains_any(topic,
                      {"aligned", "registered", "depth_to_color", "depth_to_rgb", "depth2rgb"});
}

bool says_rectified(const std::string& topic) { return contains_any(topic, {"rect"}); }

std::string camera_info_of(const std::string& topic) {
  std::string base = topic;
  for (const std::string_view transport : {"/compressedDepth", "/compressed"}) {
    if (base.ends_with(transport)) base.resize(base.size() - transport.size());
  }
  const std::size_t slash = base.rfind('/');
  return (slash == std::string::npos ? "" : base.substr(0, slash)) + "/camera_info";
}

Result<std::size_t> choose_topic(const std::vector<TopicSeen>& topics, PictureUse use,
                                 const std::string& asked, std::string_view option) {
  if (!asked.empty()) return asked_topic(topics, asked, option);
  std::vector<std::size_t> best;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (!can_be(topics[i], use)) continue;
    const int gain = best.empty() ? 1 : score(topics[i], use) - score(topics[best.front()], use);
    if (gain > 0) best.clear();
    if (gain >= 0) best.push_back(i);
  }
  if (best.size() == 1) return best.front();
  if (best.empty()) {
    const bool has_pictures = std::any_of(topics.begin(), topics.end(), is_picture);
    const auto pick = [&](const TopicSeen& topic) { return !has_pictures || is_picture(topic); };
    return Error{fmt::format("no topic of {} pictures; topics{}: {}", name_of(use),
                             has_pictures ? " of pictures" : "", listed(topics, pick))};
  }
  return Error{fmt::format("several topics can be {}: {}; say which with {}", name_of(use),
                           listed(topics,
                                  [&](const TopicSeen& topic) {
                                    return can_be(topic, use) &&
                                           score(topic, use) == score(topics[best.front()], use);
                                  }),
                           option)};
}

Result<std::size_t> choose_camera_info(const std::vector<TopicSeen>& topics, std::size_t colour,
                                       std::size_t depth, const std::string& asked) {
  const auto is_info = [](const TopicSeen& topic) {
    return topic.kind == MessageKind::camera_info && topic.messages > 0;
  };
  std::vector<std::string> wanted = {camera_info_of(topics.at(colour).name)};
  if (says_registered(topics.at(depth).name)) {
    wanted.push_back(camera_info_of(topics.at(depth).name));
  }
  if (!asked.empty()) wanted = {asked};
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (is_info(topics[i])) all.push_back(i);
  }
  for (const std::string& name : wanted) {
    for (const std::size_t i : all) {
      if (topics[i].name == name) return i;
    }
  }
  if (asked.empty() && all.size() == 1) return all.front();
  return Error{fmt::format(
      "has no CameraInfo '{}' (there are: {}); name it with --topic-camera-info, or give --camera",
      wanted.front(), listed(topics, is_info))};
}

}  // namespace ydd::sources
