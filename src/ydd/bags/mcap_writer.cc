// SPDX-License-Identifier: Apache-2.0
#include "ydd/bags/mcap_writer.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#ifdef YDD_HAS_zstd
#include <zstd.h>
#endif

#include "ydd/base/version.h"

namespace ydd {
namespace {

constexpr std::string_view kMcapStart = "\x89MCAP0\r\n";
/// What is lost at most when the process ends in the middle: three frames of 640x480.
constexpr std::size_t kChunkSize = std::size_t{4} << 20U;

enum class McapOp : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  statistics = 11,
  metadata = 12,
  metadata_index = 13,
  data_end = 15,
};

/// The body of a record, field by field.
class McapBody {
 public:
  McapBody& u16(std::uint16_t value) { return number(value, 2); }
  McapBody& u32(std::uint32_t value) { return number(value, 4); }
  McapBody& u64(std::uint64_t value) { return number(value, 8); }
  McapBody& text(std::string_view value) {
    u32(static_cast<std::uint32_t>(value.size()));
    return raw(value);
  }
  /// With a length of eight bytes.
  McapBody& blob(std::string_view value) {
    u64(value.size());
    return raw(value);
  }
  McapBody& raw(std::string_view value) { return bytes_ += value, *this; }
  std::string take() { return std::move(bytes_); }

 private:
  McapBody& number(std::uint64_t value, unsigned size) {
    for (unsigned i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i));
    return *this;
  }
  std::string bytes_;
};

void append_record(std::string& out, McapOp op, std::string_view body) {
  out += static_cast<char>(op);
  for (unsigned i = 0; i < 8; ++i) out += static_cast<char>(std::uint64_t{body.size()} >> (8 * i));
  out += body;
}

std::string record_of(McapOp op, std::string_view body) {
  std::string out;
  append_record(out, op, body);
  return out;
}

/// A chunk's text and how it is packed. Zstandard's quickest level, as bags are written while a
/// camera runs.
std::pair<std::string, std::string> packed_chunk(const std::string& text) {
#ifdef YDD_HAS_zstd
  std::string out(ZSTD_compressBound(text.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 1);
  if (ZSTD_isError(size) == 0 && size < text.size()) {
    out.resize(size);
    return {"zstd", out};
  }
#endif
  return {"", text};
}

std::string map_of(const std::map<std::uint16_t, std::uint64_t>& values) {
  McapBody body;
  for (const auto& [key, value] : values) body.u16(key).u64(value);
  return body.take();
}

}  // namespace

Result<McapWriter> McapWriter::open(const std::filesystem::path& file, std::string_view profile) {
  Result<FreshFile> fresh = FreshFile::make(follow_links(file), ".mcap");
  if (!fresh) return fresh.error();
  McapWriter out(*std::move(fresh));
  const std::string head =
      McapBody().text(profile).text(std::string("ydd-slam ") + kVersion).take();
  if (auto r = out.put(std::string(kMcapStart) + record_of(McapOp::header, head)); !r) {
    return r.error();
  }
  return out;
}

Result<void> McapWriter::put(std::string_view bytes) {
  if (!state_) return state_;
  written_ += bytes.size();
  state_ = file_.append(bytes);
  return state_;
}

std::uint16_t McapWriter::add_channel(const McapChannel& channel) {
  const std::uint16_t id = ++channels_;  // 0 is no schema
  std::string records;
  append_record(records, McapOp::schema,
                McapBody()
                    .u16(id)
                    .text(channel.schema)
                    .text(channel.schema_encoding)
                    .text(channel.definition)
                    .take());
  append_record(
      records, McapOp::channel,
      McapBody().u16(id).u16(id).text(channel.topic).text(channel.message_encoding).u32(0).take());
  records_ += records;
  chunk_ += records;  // so that a file without its end can be read
  counts_[id] = 0;
  return id;
}

Result<void> McapWriter::add_metadata(std::string_view name,
                                      const std::map<std::string, std::string>& entries) {
  McapBody pairs;
  for (const auto& [key, value] : entries) pairs.text(key).text(value);
  const std::string record =
      record_of(McapOp::metadata, McapBody().text(name).text(pairs.take()).take());
  metadata_.push_back({written_, record.size(), std::string(name)});
  return put(record);
}

Result<void> McapWriter::write(std::uint16_t channel, Timestamp time, std::string_view message) {
  const auto time_ns = static_cast<std::uint64_t>(time.ns);
  in_chunk_[channel].push_back({time_ns, chunk_.size()});
  const auto sequence = static_cast<std::uint32_t>(counts_[channel]++);
  std::string head = McapBody().u16(channel).u32(sequence).u64(time_ns).u64(time_ns).take();
  chunk_ += static_cast<char>(McapOp::message);
  for (unsigned i = 0; i < 8; ++i) {
    chunk_ += static_cast<char>(std::uint64_t{head.size() + message.size()} >> (8 * i));
  }
  chunk_ += head;
  chunk_ += message;
  return chunk_.size() < kChunkSize ? Result<void>() : flush_chunk();
}

Result<void> McapWriter::flush_chunk() {
  if (chunk_.empty()) return {};
  ChunkPlace place{
      std::numeric_limits<std::uint64_t>::max(), 0, written_, 0, 0, 0, chunk_.size(), {}};
  for (const auto& [channel, entries] : in_chunk_) {
    for (const Entry& entry : entries) {
      place.begin_ns = std::min(place.begin_ns, entry.time_ns);
      place.end_ns = std::max(place.end_ns, entry.time_ns);
    }
  }
  if (in_chunk_.empty()) place.begin_ns = 0;
  const auto* const bytes = reinterpret_cast<const Bytef*>(chunk_.data());
  const auto checksum = static_cast<std::uint32_t>(crc32_z(0, bytes, chunk_.size()));
  const auto [compression, data] = packed_chunk(chunk_);
  place.packed = data.size();
  std::string out;
  out.reserve(data.size() + 1000);
  append_record(out, McapOp::chunk,
                McapBody()
                    .u64(place.begin_ns)
                    .u64(place.end_ns)
                    .u64(chunk_.size())
                    .u32(checksum)
                    .text(compression)
                    .blob(data)
                    .take());
  place.length = out.size();
  for (const auto& [channel, entries] : in_chunk_) {
    place.indices[channel] = written_ + out.size();
    McapBody list;
    for (const Entry& entry : entries) list.u64(entry.time_ns).u64(entry.offset);
    append_record(out, McapOp::message_index, McapBody().u16(channel).text(list.take()).take());
  }
  place.index_length = out.size() - place.length;
  chunks_.push_back(std::move(place));
  chunk_.clear();
  in_chunk_.clear();
  return put(out);
}

std::string McapWriter::summary() const {
  std::string out = records_;
  McapBody statistics;
  std::uint64_t messages = 0, begin_ns = chunks_.empty() ? 0 : chunks_.front().begin_ns, end_ns = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  for (const ChunkPlace& chunk : chunks_) {
    begin_ns = std::min(begin_ns, chunk.begin_ns);
    end_ns = std::max(end_ns, chunk.end_ns);
  }
  statistics.u64(messages).u16(channels_).u32(channels_).u32(0);  // no attachments
  statistics.u32(static_cast<std::uint32_t>(metadata_.size()));
  statistics.u32(static_cast<std::uint32_t>(chunks_.size())).u64(begin_ns).u64(end_ns);
  append_record(out, McapOp::statistics, statistics.text(map_of(counts_)).take());
  for (const ChunkPlace& chunk : chunks_) {
    McapBody body;
    body.u64(chunk.begin_ns).u64(chunk.end_ns).u64(chunk.offset).u64(chunk.length);
    body.text(map_of(chunk.indices)).u64(chunk.index_length);
    body.text(chunk.packed < chunk.size ? "zstd" : "").u64(chunk.packed).u64(chunk.size);
    append_record(out, McapOp::chunk_index, body.take());
  }
  for (const MetadataPlace& place : metadata_) {
    append_record(out, McapOp::metadata_index,
                  McapBody().u64(place.offset).u64(place.length).text(place.name).take());
  }
  return out;
}

Result<void> McapWriter::finish() {
  const Result<void> ended = write_end();
  const Result<void> placed = file_.place();
  return ended ? placed : ended;
}

Result<void> McapWriter::write_end() {
  if (auto r = flush_chunk(); !r) return r;
  std::string out = record_of(McapOp::data_end, McapBody().u32(0).take());
  const std::uint64_t start = written_ + out.size();
  out += summary();
  out += record_of(McapOp::footer, McapBody().u64(start).u64(0).u32(0).take());
  out += kMcapStart;
  return put(out);
}

}  // namespace ydd
