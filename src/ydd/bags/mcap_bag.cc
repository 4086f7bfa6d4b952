// SPDX-License-Identifier: Apache-2.0
//
// MCAP (https://mcap.dev/spec), which ROS 2 records to by default: records of one byte, a length of
// eight and a body; messages and channels lie in chunks or by themselves. Walked through like a bag
// of ROS 1, so that a file that was never closed is read as well. Messages of ROS 1 ("ros1") and
// ROS 2
// ("cdr") are read.
#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "ydd/bags/chunked_bag.h"

namespace ydd::bags {
namespace {

constexpr std::uint64_t kMcapMagicSize = 8;
constexpr std::uint64_t kMcapHead = 9;  // of a record
constexpr std::uint64_t kLargestNote = 65536;
constexpr std::uint64_t kMessageHead = 22;  // channel, sequence, two times

// Kinds of records.
constexpr std::uint8_t kMcapFooter = 2, kMcapSchema = 3, kMcapChannel = 4, kMcapMessage = 5,
                       kMcapChunk = 6, kMcapMetadata = 12, kMcapDataEnd = 15;

struct McapRecord {
  std::uint8_t op = 0;
  std::uint64_t body = 0, size = 0;
};

std::optional<McapRecord> mcap_record(ByteSource& bytes, std::uint64_t offset) {
  const auto head = bytes.at(offset, kMcapHead);
  if (!head) return std::nullopt;
  return McapRecord{static_cast<std::uint8_t>(head->front()), offset + kMcapHead,
                    little_endian(head->substr(1))};
}

/// Takes the fields of a record's body one after the other; `ok` until one is not there.
class Body {
 public:
  explicit Body(std::string_view text) : rest_(text) {}
  bool ok() const { return ok_; }
  std::uint64_t number(std::size_t size) { return little_endian(take(size)); }
  std::string text() { return std::string(take(number(4))); }
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view take(std::uint64_t size) {
    ok_ = ok_ && size <= rest_.size();
    if (!ok_) return {};
    const std::string_view out = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return out;
  }
  std::string_view rest_;
  bool ok_ = true;
};

class McapIndexer {
 public:
  explicit McapIndexer(ChunkedBag& bag) : bag_(bag) {}

  /// Why it ended before its end; empty: it did not.
  std::string run() {
    ByteSource bytes(bag_.file());
    std::uint64_t offset = kMcapMagicSize;
    while (offset < bytes.size() && !ended_) {
      const auto record = mcap_record(bytes, offset);
      if (!record) return mcap_cut_at(offset);
      std::string why = take(bytes, *record, BagMessage::kNoPart);
      if (!why.empty()) return why;
      if (record->size > bytes.size() - record->body) return mcap_cut_at(offset);
      offset = record->body + record->size;
    }
    return ended_ ? "" : "was not closed by its recorder";
  }

 private:
  static std::string mcap_cut_at(std::uint64_t offset) {
    return fmt::format("is cut off or damaged at byte {}", offset);
  }

  /// Why nothing after this record can be read; empty: it can.
  std::string take(ByteSource& bytes, const McapRecord& record, std::uint32_t part) {
    const bool whole = record.size <= bytes.size() - record.body;
    switch (record.op) {
      case kMcapSchema:
      case kMcapChannel:
        if (!whole || record.size > kLargestPiece) return "";
        take_names(record.op, *bytes.at(record.body, record.size));
        return "";
      case kMcapMessage:
        if (whole) take_message(bytes, record, part);
        return "";
      case kMcapChunk:
        return part == BagMessage::kNoPart ? take_chunk(bytes, record) : "";
      case kMcapMetadata:
        if (whole && record.size <= kLargestNote) take_note(*bytes.at(record.body, record.size));
        return "";
      case kMcapDataEnd:
      case kMcapFooter:
        ended_ = true;
        return "";
      default:
        return "";
    }
  }

  void take_names(std::uint8_t op, std::string_view text) {
    Body body(text);
    const std::uint64_t id = body.number(2);
    if (op == kMcapSchema) {
      const std::string name = body.text();
      if (body.ok()) schemas_[id] = name;
      return;
    }
    const std::uint64_t schema = body.number(2);
    const std::string topic = body.text(), encoding = body.text();
    const auto type = schemas_.find(schema);
    if (!body.ok()) return;
    const bool known = encoding == "cdr" || encoding == "ros1";
    const std::string name = type == schemas_.end() ? "" : type->second;
    bag_.add_topic(id, {topic, known ? name : fmt::format("{} as {}", name, encoding),
                        encoding == "ros1" ? Wire::ros1 : Wire::cdr, 0});
  }

  void take_note(std::string_view text) {
    Body body(text);
    std::string name = body.text();
    body.number(4);  // bytes that follow
    std::map<std::string, std::string> entries;
    while (body.ok() && body.left() > 0) {
      std::string key = body.text();
      entries[std::move(key)] = body.text();
    }
    if (body.ok()) bag_.add_note(std::move(name), std::move(entries));
  }

  void take_message(ByteSource& bytes, const McapRecord& record, std::uint32_t part) {
    if (record.size < kMessageHead || record.size > kLargestPiece) return;
    const auto head = bytes.at(record.body, std::min(record.size, kMessageHead + 16));
    if (!head) return;
    Body body(*head);
    const std::uint64_t channel = body.number(2);
    body.number(4);  // of the sequence
    BagMessage message;
    message.received.ns = static_cast<std::int64_t>(body.number(8));
    message.part = part;
    message.offset = record.body + kMessageHead;
    message.size = record.size - kMessageHead;
    bag_.add_message(channel, message, head->substr(kMessageHead));
  }

  std::string take_chunk(ByteSource& bytes, const McapRecord& record) {
    constexpr std::uint64_t kFixed = 8 + 8 + 8 + 4;  // times, size, checksum
    constexpr std::uint64_t kLongestName = 64;       // of the compression
    const std::uint64_t there = bytes.size() - record.body;
    const auto head =
        bytes.at(record.body, std::min({record.size, there, kFixed + 12 + kLongestName}));
    if (!head) return mcap_cut_at(record.body);
    Body body(*head);
    body.number(8), body.number(8);
    const std::uint64_t size = body.number(8), checksum = body.number(4);
    const std::string compression = body.text();
    const std::uint64_t packed = body.number(8);
    if (!body.ok()) return mcap_cut_at(record.body);
    const std::uint64_t data = record.body + kFixed + 4 + compression.size() + 8;
    if (compression.empty()) {
      return walk(bytes, data, data + std::min(packed, bytes.size() - data), BagMessage::kNoPart);
    }
    if (packed > bytes.size() - data) return "";  // the walk says so
    auto chunk = bag_.add_chunk({data, packed, size, compression});
    if (!chunk) return fmt::format("has at byte {} {}", data, chunk.error().message);
    const auto* const text = reinterpret_cast<const Bytef*>(chunk->text.data());
    if (checksum != 0 && checksum != crc32_z(0, text, chunk->text.size())) {
      return fmt::format("has at byte {} a chunk whose checksum is wrong", data);
    }
    ByteSource inner{std::string_view(chunk->text)};
    return walk(inner, 0, chunk->text.size(), chunk->number);
  }

  /// The records of a chunk.
  std::string walk(ByteSource& bytes, std::uint64_t offset, std::uint64_t end, std::uint32_t part) {
    while (offset < end) {
      const auto record = mcap_record(bytes, offset);
      if (!record || record->body > end || record->size > end - record->body) {
        return mcap_cut_at(offset);
      }
      if (record->op >= kMcapSchema && record->op <= kMcapMessage) take(bytes, *record, part);
      offset = record->body + record->size;
    }
    return "";
  }

  ChunkedBag& bag_;
  std::map<std::uint64_t, std::string> schemas_;
  bool ended_ = false;
};

}  // namespace

Result<std::shared_ptr<const Bag>> open_mcap_bag(const std::filesystem::path& path) {
  Result<BagFile> file = BagFile::open(path);
  if (!file) return file.error();
  const auto bag = std::make_shared<ChunkedBag>(*std::move(file));
  bag->set_incomplete(McapIndexer(*bag).run());
  return std::shared_ptr<const Bag>(bag);
}

}  // namespace ydd::bags
