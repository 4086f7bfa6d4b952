// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ydd/base/files.h"
#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"

namespace ydd {

/// A kind of messages in an MCAP file.
struct McapChannel {
  std::string topic;
  std::string schema;            ///< "sensor_msgs/msg/Image"
  std::string schema_encoding;   ///< "ros2msg", "jsonschema"
  std::string definition;        ///< the schema itself
  std::string message_encoding;  ///< "cdr", "json"
};

/// Writes an MCAP file (https://mcap.dev/spec): chunks with an index, compressed where a library
/// for it is there, and a summary at the end. The file appears when it is finished; until then it
/// has a hidden name beside it, and can be read up to the last chunk if the process ends before.
///
/// Thread: one. After a failure nothing more is written.
class McapWriter {
 public:
  /// `profile`: "ros2" where all messages are of ROS 2, else empty.
  static Result<McapWriter> open(const std::filesystem::path& file, std::string_view profile);

  /// The number by which messages name it.
  std::uint16_t add_channel(const McapChannel& channel);
  /// Names and texts for whoever looks for `name`.
  Result<void> add_metadata(std::string_view name,
                            const std::map<std::string, std::string>& entries);
  Result<void> write(std::uint16_t channel, Timestamp time, std::string_view message);
  /// Writes what is left and the summary, and renames the file into place: also after a failure,
  /// which it tells again, for what is in it.
  Result<void> finish();

  /// What it is called until then.
  const std::filesystem::path& hidden_name() const { return file_.path(); }

 private:
  explicit McapWriter(FreshFile file) : file_(std::move(file)) {}
  Result<void> put(std::string_view bytes);
  Result<void> flush_chunk();
  Result<void> write_end();
  std::string summary() const;

  struct Entry {
    std::uint64_t time_ns, offset;  ///< of a message in its chunk
  };
  struct ChunkPlace {
    std::uint64_t begin_ns, end_ns, offset, length, index_length, packed, size;
    std::map<std::uint16_t, std::uint64_t> indices;  ///< where that of a channel is
  };
  struct MetadataPlace {
    std::uint64_t offset, length;
    std::string name;
  };

  FreshFile file_;
  Result<void> state_;  ///< the first failure
  std::uint64_t written_ = 0;
  std::string records_;  ///< of schemas and channels, for the summary
  std::string chunk_;
  std::map<std::uint16_t, std::vector<Entry>> in_chunk_;
  std::vector<ChunkPlace> chunks_;
  std::vector<MetadataPlace> metadata_;
  std::map<std::uint16_t, std::uint64_t> counts_;  ///< of messages, by channel
  std::uint16_t channels_ = 0;
};

}  // namespace ydd
