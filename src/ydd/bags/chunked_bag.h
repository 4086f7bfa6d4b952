// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/bags/bag.h"
#include "ydd/bags/byte_source.h"
#include "ydd/base/published.h"

/// What bags of ROS 1 and MCAP have in common: records in a file, many of them in chunks that are
/// compressed. Inside this room only.
namespace ydd::bags {

/// A compressed chunk.
struct Chunk {
  std::uint64_t offset = 0;  ///< of its data in the file
  std::uint64_t packed = 0, size = 0;
  std::string compression;
};

/// Its messages are those of the file itself (BagMessage::kNoPart) or of a chunk. It keeps the
/// chunk that was read last.
class ChunkedBag : public Bag {
 public:
  explicit ChunkedBag(BagFile file) : file_(std::move(file)) {}

  Result<std::string> read(const BagMessage& message) const override;

  // While it is being indexed:

  const BagFile& file() const { return file_; }
  /// The topic of connection or channel `id`; connections may share a topic.
  void add_topic(std::uint64_t id, BagTopic topic);
  /// A message of connection `id`, whose bytes begin with `start`. Connections that are not known
  /// are passed over.
  void add_message(std::uint64_t id, BagMessage message, std::string_view start);
  /// A chunk and its text, to be indexed with that number as part.
  struct OpenedChunk {
    std::uint32_t number = 0;
    std::string text;
  };
  Result<OpenedChunk> add_chunk(Chunk chunk);
  void add_note(std::string name, std::map<std::string, std::string> entries) {
    notes_.emplace(std::move(name), std::move(entries));
  }
  void set_incomplete(std::string why) { incomplete_ = std::move(why); }

 private:
  Result<std::string> text_of(const Chunk& chunk) const;

  struct CachedChunk {
    std::uint32_t number = 0;
    std::string text;
  };

  BagFile file_;
  std::vector<Chunk> chunks_;
  std::map<std::uint64_t, std::uint32_t> topic_of_id_;
  mutable Published<CachedChunk> newest_;
};

Result<std::shared_ptr<const Bag>> open_ros1_bag(const std::filesystem::path& file);
Result<std::shared_ptr<const Bag>> open_mcap_bag(const std::filesystem::path& file);
Result<std::shared_ptr<const Bag>> open_sqlite_bag(const std::filesystem::path& file);

}  // namespace ydd::bags
