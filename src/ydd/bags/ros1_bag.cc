// SPDX-License-Identifier: Apache-2.0
//
// Bags of ROS 1, format 2.0 (http://wiki.ros.org/Bags/Format/2.0): records of a header (fields
// "name=value") and data; messages and connections lie in chunks.
//
// Why not rosbag's own library (librosbag-storage-dev): it brings 31 packages (Boost, GPGME,
// pluginlib), and it refuses a bag that was not closed until `rosbag reindex` has written it anew,
// where we read up to the last whole message. So the index at the end of a bag is not used: the
// records are walked through, which needs a few bytes of each as long as chunks are not compressed.
#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "ydd/bags/chunked_bag.h"

namespace ydd::bags {
namespace {

constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";
constexpr std::uint64_t kLongestHeader = 1U << 24U;

// The field "op" of a record.
constexpr std::uint64_t kMessage = 2, kBagHeader = 3, kChunk = 5, kConnection = 7;

/// Fields of a header: "name=value", each after its length. What is missing is empty.
class Fields {
 public:
  explicit Fields(std::string_view text) : text_(text) {}
  std::string_view get(std::string_view name) const {
    std::string_view rest = text_;
    while (rest.size() >= 4) {
      const std::uint64_t size = little_endian(rest.substr(0, 4));
      rest.remove_prefix(4);
      if (size > rest.size()) return {};
      const std::string_view field = rest.substr(0, size);
      rest.remove_prefix(size);
      const std::size_t end = field.find('=');
      if (end != std::string_view::npos && field.substr(0, end) == name) {
        return field.substr(end + 1);
      }
    }
    return {};
  }
  std::uint64_t number(std::string_view name) const {
    const std::string_view value = get(name);
    return value.size() > 8 ? 0 : little_endian(value);
  }

 private:
  std::string_view text_;
};

struct Ros1Record {
  std::string header;
  std::uint64_t data = 0, size = 0;  ///< where its data is
};

/// The record at `offset`; nothing when its header is not whole. Its data may reach beyond the end.
std::optional<Ros1Record> ros1_record(ByteSource& bytes, std::uint64_t offset) {
  const auto header_size = bytes.at(offset, 4);
  if (!header_size) return std::nullopt;
  const std::uint64_t size = little_endian(*header_size);
  if (size > kLongestHeader) return std::nullopt;
  const auto header = bytes.at(offset + 4, size);
  if (!header) return std::nullopt;
  Ros1Record out{std::string(*header), offset + 8 + size, 0};
  const auto data_size = bytes.at(offset + 4 + size, 4);
  if (!data_size) return std::nullopt;
  out.size = little_endian(*data_size);
  return out;
}

class Ros1Indexer {
 public:
  explicit Ros1Indexer(ChunkedBag& bag) : bag_(bag) {}

  /// Why it ended before its end; empty: it did not.
  std::string run() {
    ByteSource bytes(bag_.file());
    std::uint64_t offset = kRos1Magic.size();
    while (offset < bytes.size()) {
      const auto record = ros1_record(bytes, offset);
      if (!record) return cut_at(offset);
      std::string why = take(bytes, *record, BagMessage::kNoPart);
      if (!why.empty()) return why;
      if (record->size > bytes.size() - record->data) return cut_at(offset);
      offset = record->data + record->size;
    }
    return was_closed_ ? "" : "was not closed by its recorder";
  }

 private:
  static std::string cut_at(std::uint64_t offset) {
    return fmt::format("is cut off or damaged at byte {}", offset);
  }

  /// Why nothing after this record can be read; empty: it can.
  std::string take(ByteSource& bytes, const Ros1Record& record, std::uint32_t part) {
    const Fields fields(record.header);
    switch (fields.number("op")) {
      case kBagHeader:
        was_closed_ = fields.number("index_pos") != 0;
        if (!fields.get("encryptor").empty()) return "is encrypted";
        return "";
      case kConnection:
        return take_connection(bytes, record, fields);
      case kMessage:
        take_message(bytes, record, fields, part);
        return "";
      case kChunk:
        return part == BagMessage::kNoPart ? take_chunk(bytes, record, fields) : "";
      default:
        return "";
    }
  }

  std::string take_connection(ByteSource& bytes, const Ros1Record& record, const Fields& fields) {
    const auto data = bytes.at(record.data, record.size);
    if (!data) return "";  // cut off here: the walk says so
    const std::string type(Fields(*data).get("type"));
    bag_.add_topic(fields.number("conn"), {std::string(fields.get("topic")), type, Wire::ros1, 0});
    return "";
  }

  void take_message(ByteSource& bytes, const Ros1Record& record, const Fields& fields,
                    std::uint32_t part) {
    if (record.size > kLargestPiece || record.data > bytes.size() ||
        record.size > bytes.size() - record.data) {
      return;
    }
    const std::uint64_t time = fields.number("time");  // seconds, then nanoseconds above
    BagMessage message;
    message.part = part;
    message.offset = record.data;
    message.size = record.size;
    message.received.ns =
        static_cast<std::int64_t>((time & 0xFFFFFFFFU) * 1'000'000'000 + (time >> 32U));
    const auto start = bytes.at(record.data, std::min<std::uint64_t>(record.size, 16));
    bag_.add_message(fields.number("conn"), message, start.value_or(std::string_view()));
  }

  std::string take_chunk(ByteSource& bytes, const Ros1Record& record, const Fields& fields) {
    const std::string_view compression = fields.get("compression");
    if (compression == "none") {
      const std::uint64_t end = record.data + std::min(record.size, bytes.size() - record.data);
      return walk(bytes, record.data, end, BagMessage::kNoPart);
    }
    if (record.size > bytes.size() - record.data) return "";  // the walk says so
    auto chunk =
        bag_.add_chunk({record.data, record.size, fields.number("size"), std::string(compression)});
    if (!chunk) return fmt::format("has at byte {} {}", record.data, chunk.error().message);
    ByteSource text{std::string_view(chunk->text)};
    return walk(text, 0, chunk->text.size(), chunk->number);
  }

  /// The records of a chunk.
  std::string walk(ByteSource& bytes, std::uint64_t offset, std::uint64_t end, std::uint32_t part) {
    while (offset < end) {
      const auto record = ros1_record(bytes, offset);
      if (!record || record->data > end || record->size > end - record->data) {
        return cut_at(offset);
      }
      const Fields fields(record->header);
      const std::uint64_t op = fields.number("op");
      if (op == kConnection) take_connection(bytes, *record, fields);
      if (op == kMessage) take_message(bytes, *record, fields, part);
      offset = record->data + record->size;
    }
    return "";
  }

  ChunkedBag& bag_;
  bool was_closed_ = false;
};

}  // namespace

Result<std::shared_ptr<const Bag>> open_ros1_bag(const std::filesystem::path& path) {
  Result<BagFile> file = BagFile::open(path);
  if (!file) return file.error();
  const auto bag = std::make_shared<ChunkedBag>(*std::move(file));
  bag->set_incomplete(Ros1Indexer(*bag).run());
  return std::shared_ptr<const Bag>(bag);
}

}  // namespace ydd::bags
