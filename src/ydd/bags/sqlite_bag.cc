// SPDX-License-Identifier: Apache-2.0
//
// Bags of ROS 2 in SQLite (rosbag2_storage_sqlite3): tables topics(id, name, type,
// serialization_format) and messages(id, topic_id, timestamp, data); `data` may be packed by zstd,
// message by message.
#include <sqlite3.h>

#include <algorithm>
#include <climits>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "ydd/bags/byte_source.h"
#include "ydd/bags/chunked_bag.h"
#include "ydd/base/one_line.h"
#include "ydd/messages/ros_messages.h"

namespace ydd::bags {
namespace {

struct CloseSqlite {
  void operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  void operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }
};
using Connection = std::unique_ptr<sqlite3, CloseSqlite>;
using Statement = std::unique_ptr<sqlite3_stmt, CloseSqlite>;
using Blob = std::unique_ptr<sqlite3_blob, CloseSqlite>;

std::string column_text(sqlite3_stmt* statement, int column) {
  const unsigned char* const text = sqlite3_column_text(statement, column);
  const int size = sqlite3_column_bytes(statement, column);
  return text ? std::string(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size))
              : "";
}

/// As SQLite wants to have it: nothing is written beside the file, and no lock is needed. Only
/// where a recorder left a journal that has not been taken over yet, that must be read as well.
std::string uri_of(const std::filesystem::path& file) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    const bool means_something = c == '?' || c == '#' || c == '%';
    uri += means_something ? fmt::format("%{:02x}", static_cast<unsigned>(c)) : std::string(1, c);
  }
  std::error_code failure;
  const auto journal = std::filesystem::file_size(file.string() + "-wal", failure);
  return failure || journal == 0 ? uri + "?immutable=1" : uri;
}

/// A file of others: nothing in it is run, and none of its rows can be larger than a message.
/// `cut`: also one that is shorter than it says.
Connection open_readonly(const std::filesystem::path& file, bool cut) {
  sqlite3* raw = nullptr;
  const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_FULLMUTEX | SQLITE_OPEN_URI;
  const int code = sqlite3_open_v2(uri_of(file).c_str(), &raw, flags, nullptr);
  Connection out(raw);
  if (code != SQLITE_OK) return nullptr;
  sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, static_cast<int>(kLargestPiece));
  sqlite3_limit(raw, SQLITE_LIMIT_SQL_LENGTH, 100'000);
  sqlite3_limit(raw, SQLITE_LIMIT_ATTACHED, 0);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  if (cut) sqlite3_db_config(raw, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  return out;
}

Statement prepare(sqlite3* connection, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(connection, sql, -1, &raw, nullptr) != SQLITE_OK) return nullptr;
  return Statement(raw);
}

/// Whether both are tables: a view of others could take for ever.
bool has_tables(sqlite3* connection) {
  const Statement statement = prepare(
      connection,
      "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages') "
      "AND sql NOT LIKE '%VIRTUAL%'");
  return statement && sqlite3_step(statement.get()) == SQLITE_ROW &&
         sqlite3_column_int(statement.get(), 0) == 2;
}

/// Whether the file ends within a page, of which SQLite then takes the rest for zeros.
bool ends_within_a_page(const std::filesystem::path& path) {
  constexpr std::uint64_t kPlace = 16;  // of the page's size, big endian; 1 is 65536
  const Result<BagFile> file = BagFile::open(path);
  const std::string told = file ? file->read(kPlace, 2).value_or("") : "";
  if (told.size() != 2) return false;
  const unsigned high = static_cast<unsigned char>(told[0]);
  const unsigned size = high << 8U | static_cast<unsigned char>(told[1]);
  return size != 0 && file->size() % (size == 1 ? 65536 : size) != 0;
}

class SqliteBag : public Bag {
 public:
  explicit SqliteBag(std::filesystem::path file) : file_(std::move(file)) {}

  Result<void> index() {
    connection_ = open_readonly(file_, false);
    bool cut = false;
    if (!connection_ || !has_tables(connection_.get())) {
      connection_ = open_readonly(file_, true);
      cut = true;
      if (!connection_ || !has_tables(connection_.get())) {
        return failure("is an SQLite file, but no bag of ROS 2 (tables topics and messages)");
      }
    }
    if (!index_topics()) return failure("is damaged: its topics cannot be read");
    in_page_ = ends_within_a_page(file_);
    cut = cut || in_page_;
    if (!index_messages()) incomplete_ = "is damaged";
    // What is left of the last page is most likely of the last message.
    if (in_page_ && !messages_.empty()) messages_.pop_back();
    if (cut) incomplete_ = "is cut off";
    return {};
  }

  Result<std::string> read(const BagMessage& message) const override {
    std::optional<std::string> bytes = start_of(message, kLargestPiece);
    if (!bytes) return failure(fmt::format("message {} cannot be read", message.offset));
    if (!is_zstd(*bytes)) return *std::move(bytes);
    Result<std::string> unpacked = decompressed_zstd(*bytes);
    if (!unpacked) {
      return failure(fmt::format("message {}: {}", message.offset, unpacked.error().message));
    }
    return unpacked;
  }

 private:
  Error failure(const std::string& reason) const {
    return Error{fmt::format("{}: {}", file_.string(), reason)};
  }

  bool index_topics() {
    const Statement statement =
        prepare(connection_.get(), "SELECT id, name, type, serialization_format FROM topics");
    if (!statement) return false;
    int code = SQLITE_ROW;
    while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
      const std::string format = column_text(statement.get(), 3);
      std::string type = column_text(statement.get(), 2);
      if (format != "cdr") type += " as " + format;
      topic_of_id_[sqlite3_column_int64(statement.get(), 0)] =
          static_cast<std::uint32_t>(topics_.size());
      topics_.push_back(
          {on_one_line(column_text(statement.get(), 1)), on_one_line(type), Wire::cdr, 0});
    }
    return code == SQLITE_DONE;
  }

  bool index_messages() {
    const Statement statement =
        prepare(connection_.get(), "SELECT rowid, topic_id, timestamp FROM messages");
    if (!statement) return false;
    int code = SQLITE_ROW;
    while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
      const auto topic = topic_of_id_.find(sqlite3_column_int64(statement.get(), 1));
      if (topic == topic_of_id_.end()) continue;
      BagTopic& of = topics_[topic->second];
      ++of.messages;
      if (message_kind(of.type) == MessageKind::other) continue;
      BagMessage message;
      message.topic = topic->second;
      message.offset = static_cast<std::uint64_t>(sqlite3_column_int64(statement.get(), 0));
      message.received.ns = sqlite3_column_int64(statement.get(), 2);
      const std::optional<Timestamp> stamp = stamp_of_message(message);
      if (!stamp || (in_page_ && stamp->ns == 0)) return false;  // its pages are not there
      message.stamp = *stamp;
      messages_.push_back(message);
    }
    return code == SQLITE_DONE;
  }

  /// Only the pages with its first bytes are read.
  std::optional<Timestamp> stamp_of_message(const BagMessage& message) const {
    std::optional<std::string> start = start_of(message, kHeaderStart);
    if (!start) return std::nullopt;
    if (is_zstd(*start)) {
      Result<std::string> whole = read(message);
      if (!whole) return std::nullopt;
      start = *std::move(whole);
    }
    return header_stamp(*start, Wire::cdr).value_or(Timestamp{});
  }

  std::optional<std::string> start_of(const BagMessage& message, std::uint64_t most) const {
    sqlite3_blob* raw = nullptr;
    const int code = sqlite3_blob_open(connection_.get(), "main", "messages", "data",
                                       static_cast<sqlite3_int64>(message.offset), 0, &raw);
    const Blob blob(raw);
    if (code != SQLITE_OK) return std::nullopt;
    const auto size = std::min<std::uint64_t>(
        most, static_cast<std::uint64_t>(std::max(0, sqlite3_blob_bytes(raw))));
    std::string out(size, '\0');
    if (sqlite3_blob_read(raw, out.data(), static_cast<int>(size), 0) != SQLITE_OK) {
      return std::nullopt;
    }
    return out;
  }

  std::filesystem::path file_;
  Connection connection_;
  bool in_page_ = false;  ///< it ends within a page
  std::map<std::int64_t, std::uint32_t> topic_of_id_;
};

}  // namespace

Result<std::shared_ptr<const Bag>> open_sqlite_bag(const std::filesystem::path& path) {
  const auto bag = std::make_shared<SqliteBag>(path);
  if (auto r = bag->index(); !r) return r.error();
  return std::shared_ptr<const Bag>(bag);
}

}  // namespace ydd::bags
