// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#ifdef YDD_HAS_bz2
#include <bzlib.h>
#endif
#ifdef YDD_HAS_lz4
#include <lz4frame.h>
#endif
#ifdef YDD_HAS_zstd
#include <zstd.h>
#endif

#include "ydd/base/timestamp.h"

/// Small writers of bags, for tests: as the formats describe them, nothing of the reader is used.
namespace ydd::bags {

struct WrittenMessage {
  std::string topic, type;
  Timestamp received;
  std::string bytes;
};
using WrittenMessages = std::vector<WrittenMessage>;

inline std::string little(std::uint64_t value, std::size_t size) {
  std::string out;
  for (std::size_t i = 0; i < size; ++i) {
    out += static_cast<char>(i < sizeof value ? value >> (8 * i) : 0);
  }
  return out;
}
inline std::string with_length(std::string_view text, std::size_t size = 4) {
  return little(text.size(), size) + std::string(text);
}

/// "none" and "" leave it as it is.
inline std::string packed(std::string_view kind, const std::string& text) {
  if (kind == "none" || kind.empty()) return text;
  std::string out(2 * text.size() + 1000, '\0');
#ifdef YDD_HAS_bz2
  if (kind == "bz2") {
    auto size = static_cast<unsigned>(out.size());
    BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(text.data()),
                             static_cast<unsigned>(text.size()), 9, 0, 30);
    return out.substr(0, size);
  }
#endif
#ifdef YDD_HAS_lz4
  if (kind == "lz4") {
    return out.substr(
        0, LZ4F_compressFrame(out.data(), out.size(), text.data(), text.size(), nullptr));
  }
#endif
#ifdef YDD_HAS_zstd
  if (kind == "zstd") {
    return out.substr(0, ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 3));
  }
#endif
  throw std::runtime_error("built without " + std::string(kind));
}

/// Numbers of topics, in the order of their first message.
inline std::map<std::string, std::uint32_t> topic_numbers(const WrittenMessages& messages) {
  std::map<std::string, std::uint32_t> out;
  for (const WrittenMessage& m : messages) out.emplace(m.topic, out.size());
  return out;
}

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

// --- ROS 1 --------------------------------------------------------------------------------------

using Ros1Fields = std::vector<std::pair<std::string, std::string>>;

inline std::string ros1_fields(const Ros1Fields& fields) {
  std::string out;
  for (const auto& [name, value] : fields) {
    out += with_length(std::string(name).append("=").append(value));
  }
  return out;
}
inline std::string ros1_text(const Ros1Fields& fields, std::string_view data) {
  return with_length(ros1_fields(fields)) + with_length(data);
}

/// A chunk for each `per_chunk` messages, without an index; `closed`: as its bag header says.
inline std::string ros1_bag(const WrittenMessages& messages, const std::string& compression,
                            std::size_t per_chunk = 2, bool closed = true) {
  std::string out = "#ROSBAG V2.0\n";
  const std::string head = ros1_fields({{"op", "\3"},
                                        {"index_pos", little(closed ? 4117 : 0, 8)},
                                        {"conn_count", little(1, 4)},
                                        {"chunk_count", little(1, 4)}});
  out += with_length(head) + with_length(std::string(4096 - 8 - head.size(), ' '));
  const auto numbers = topic_numbers(messages);
  std::map<std::string, bool> told;
  for (std::size_t i = 0; i < messages.size(); i += per_chunk) {
    std::string chunk;
    for (std::size_t j = i; j < std::min(messages.size(), i + per_chunk); ++j) {
      const WrittenMessage& m = messages[j];
      const std::string conn = little(numbers.at(m.topic), 4);
      if (!std::exchange(told[m.topic], true)) {
        chunk += ros1_text({{"op", "\7"}, {"conn", conn}, {"topic", m.topic}},
                           ros1_fields({{"topic", m.topic}, {"type", m.type}, {"md5sum", "*"}}));
      }
      const std::string time = little(std::uint64_t(m.received.ns) / 1'000'000'000, 4) +
                               little(std::uint64_t(m.received.ns) % 1'000'000'000, 4);
      chunk += ros1_text({{"op", "\2"}, {"conn", conn}, {"time", time}}, m.bytes);
    }
    out +=
        ros1_text({{"op", "\5"}, {"compression", compression}, {"size", little(chunk.size(), 4)}},
                  packed(compression, chunk));
  }
  return out;
}

// --- MCAP ---------------------------------------------------------------------------------------

inline std::string mcap_text(int op, const std::string& body) {
  return std::string(1, static_cast<char>(op)) + with_length(body, 8);
}

/// `compression`: "", "lz4" or "zstd"; "no chunks": messages stand by themselves.
inline std::string mcap_bag(const WrittenMessages& messages, const std::string& compression,
                            const std::string& encoding = "cdr", std::size_t per_chunk = 2,
                            bool closed = true) {
  std::string out = "\x89MCAP0\r\n" + mcap_text(1, with_length("ros2") + with_length("test"));
  const auto numbers = topic_numbers(messages);
  std::map<std::string, bool> told;
  for (std::size_t i = 0; i < messages.size(); i += per_chunk) {
    std::string chunk;
    for (std::size_t j = i; j < std::min(messages.size(), i + per_chunk); ++j) {
      const WrittenMessage& m = messages[j];
      const std::string id = little(numbers.at(m.topic) + 1, 2);
      if (!std::exchange(told[m.topic], true)) {
        chunk += mcap_text(3, id + with_length(m.type) + with_length("ros2msg") + with_length(""));
        chunk +=
            mcap_text(4, id + id + with_length(m.topic) + with_length(encoding) + little(0, 4));
      }
      const std::string time = little(std::uint64_t(m.received.ns), 8);
      std::string message = id + little(j, 4);
      message.append(time).append(time).append(m.bytes);
      chunk += mcap_text(5, message);
    }
    if (compression == "no chunks") {
      out += chunk;
      continue;
    }
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), uInt(chunk.size()));
    out += mcap_text(6, little(0, 16) + little(chunk.size(), 8) + little(crc, 4) +
                            with_length(compression) + with_length(packed(compression, chunk), 8));
  }
  if (!closed) return out;
  out += mcap_text(15, little(0, 4)) + mcap_text(2, little(0, 20));
  return out + "\x89MCAP0\r\n";
}

// --- ROS 2 in SQLite ----------------------------------------------------------------------------

/// With rosbag2's tables. `compression`: "" or "zstd", message by message.
inline void write_sqlite_bag(const std::filesystem::path& file, const WrittenMessages& messages,
                             const std::string& compression = "") {
  sqlite3* db = nullptr;
  if (sqlite3_open(file.c_str(), &db) != SQLITE_OK) throw std::runtime_error("no database");
  const auto run = [&](const char* sql) { sqlite3_exec(db, sql, nullptr, nullptr, nullptr); };
  run("BEGIN");
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
      "timestamp INTEGER NOT NULL, data BLOB NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  const auto insert = [&](const char* sql, const auto& bind) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(db, sql, -1, &statement, nullptr);
    bind(statement);
    if (sqlite3_step(statement) != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(db));
    sqlite3_finalize(statement);
  };
  const auto numbers = topic_numbers(messages);
  std::map<std::string, bool> told;
  for (const WrittenMessage& m : messages) {
    const int id = static_cast<int>(numbers.at(m.topic)) + 1;
    if (!std::exchange(told[m.topic], true)) {
      insert("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", [&](sqlite3_stmt* s) {
        sqlite3_bind_int(s, 1, id);
        sqlite3_bind_text(s, 2, m.topic.c_str(), -1, SQLITE_TRANSIENT);
        sqlite3_bind_text(s, 3, m.type.c_str(), -1, SQLITE_TRANSIENT);
      });
    }
    const std::string data = packed(compression, m.bytes);
    insert("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
           [&](sqlite3_stmt* s) {
             sqlite3_bind_int(s, 1, id);
             sqlite3_bind_int64(s, 2, m.received.ns);
             sqlite3_bind_blob(s, 3, data.data(), int(data.size()), SQLITE_TRANSIENT);
           });
  }
  run("COMMIT");
  sqlite3_close(db);
}

}  // namespace ydd::bags
