// SPDX-License-Identifier: Apache-2.0
#include "ydd/bags/chunked_bag.h"

#include <utility>

#include <fmt/format.h>

#include "ydd/base/one_line.h"
#include "ydd/messages/ros_messages.h"

namespace ydd::bags {

void ChunkedBag::add_topic(std::uint64_t id, BagTopic topic) {
  if (topic_of_id_.contains(id)) return;
  topic.name = on_one_line(topic.name);
  topic.type = on_one_line(topic.type);
  for (std::uint32_t i = 0; i < topics_.size(); ++i) {
    if (topics_[i].name != topic.name || topics_[i].type != topic.type ||
        topics_[i].wire != topic.wire) {
      continue;
    }
    topic_of_id_[id] = i;
    return;
  }
  topic_of_id_[id] = static_cast<std::uint32_t>(topics_.size());
  topics_.push_back(std::move(topic));
}

void ChunkedBag::add_message(std::uint64_t id, BagMessage message, std::string_view start) {
  const auto topic = topic_of_id_.find(id);
  if (topic == topic_of_id_.end()) return;
  BagTopic& of = topics_[topic->second];
  ++of.messages;
  if (message_kind(of.type) == MessageKind::other) return;
  message.topic = topic->second;
  message.stamp = header_stamp(start, of.wire).value_or(Timestamp{});
  messages_.push_back(message);
}

Result<ChunkedBag::OpenedChunk> ChunkedBag::add_chunk(Chunk chunk) {
  Result<std::string> text = text_of(chunk);
  if (!text) return text.error();
  chunks_.push_back(std::move(chunk));
  return OpenedChunk{static_cast<std::uint32_t>(chunks_.size() - 1), *std::move(text)};
}

Result<std::string> ChunkedBag::text_of(const Chunk& chunk) const {
  const std::optional<std::string> packed = file_.read(chunk.offset, chunk.packed);
  if (!packed) return Error{"cannot be read"};
  return decompressed(chunk.compression, *packed, chunk.size);
}

Result<std::string> ChunkedBag::read(const BagMessage& message) const {
  const auto failure = [&](const std::string& reason) {
    return Error{fmt::format("{}: byte {}: {}", file_.path().string(), message.offset, reason)};
  };
  if (message.part == BagMessage::kNoPart) {
    std::optional<std::string> bytes = file_.read(message.offset, message.size);
    if (!bytes) return failure("a message cannot be read");
    return *std::move(bytes);
  }
  std::shared_ptr<const CachedChunk> chunk = newest_.get();
  if (!chunk || chunk->number != message.part) {
    Result<std::string> text = text_of(chunks_.at(message.part));
    if (!text) return failure(text.error().message);
    chunk = std::make_shared<const CachedChunk>(CachedChunk{message.part, *std::move(text)});
    newest_.set(chunk);
  }
  if (message.offset > chunk->text.size() || message.size > chunk->text.size() - message.offset) {
    return failure("a message reaches beyond its chunk");
  }
  return chunk->text.substr(message.offset, message.size);
}

}  // namespace ydd::bags
