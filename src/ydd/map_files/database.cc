// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/database.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_header.h"
#include "ydd/map_files/map_schema.h"

namespace ydd::map_format {
namespace {

/// Steps of SQLite's machine that reading a map can need: a few for each row and page. Whatever
/// takes more was made to take for ever.
constexpr std::int64_t kStepsPerByte = 20;
constexpr std::int64_t kStepsOfAnyMap = 20'000'000;
constexpr int kStepsPerCall = 10'000;

/// Of PBKDF2 for each key that is made of a pass phrase.
constexpr int kCipherRounds = 256'000;

constexpr int kPatience_ms = 10'000;  // for a reader to let the writer commit, and vice versa

Value cell(const SqliteLibrary& sql, sqlite3_stmt& statement, int column) {
  switch (sql.column_type(&statement, column)) {
    case SQLITE_INTEGER:
      return sql.column_int64(&statement, column);
    case SQLITE_BLOB: {
      const void* const data = sql.column_blob(&statement, column);
      const int size = sql.column_bytes(&statement, column);
      return data ? std::string(static_cast<const char*>(data), static_cast<std::size_t>(size))
                  : std::string();
    }
    default:
      throw Fault("a cell of the wrong type");
  }
}

Row row_of(const SqliteLibrary& sql, sqlite3_stmt& statement, int columns) {
  Row row;
  row.key = sql.column_int64(&statement, 0);
  for (int i = 1; i <= columns; ++i) row.values.push_back(cell(sql, statement, i));
  return row;
}

int bind(const SqliteLibrary& sql, sqlite3_stmt& statement, int index, const Value& value) {
  if (const auto* const number = std::get_if<std::int64_t>(&value)) {
    return sql.bind_int64(&statement, index, *number);
  }
  const std::string& bytes = std::get<std::string>(value);
  return sql.bind_blob64(&statement, index, bytes.data(), bytes.size(), SQLITE_STATIC);
}

}  // namespace

std::int64_t Row::integer(std::size_t i) const {
  const auto* const value = std::get_if<std::int64_t>(&values.at(i));
  if (!value) throw Fault("a cell of the wrong type");
  return *value;
}

std::uint32_t Row::number(std::size_t i, std::uint32_t largest) const {
  const std::int64_t value = integer(i);
  if (value < 0 || value > largest) throw Fault("a number that is too large");
  return static_cast<std::uint32_t>(value);
}

const std::string& Row::bytes(std::size_t i) const {
  const auto* const value = std::get_if<std::string>(&values.at(i));
  if (!value) throw Fault("a cell of the wrong type");
  return *value;
}

std::uint64_t checksum_of(const TableShape& table, const Row& row) {
  Checksum sum;
  sum.add(std::string_view(table.name));
  sum.add(static_cast<std::uint64_t>(row.key));
  for (const Value& value : row.values) {
    if (const auto* const number = std::get_if<std::int64_t>(&value)) {
      sum.add(static_cast<std::uint64_t>(*number));
    } else {
      sum.add(std::string_view(std::get<std::string>(value)));
    }
  }
  return sum.value();
}

void Database::Close::operator()(sqlite3* connection) const { sql->close_v2(connection); }
void Database::Close::operator()(sqlite3_stmt* statement) const { sql->finalize(statement); }

int Database::count_steps(void* steps_left) {
  auto& left = *static_cast<std::int64_t*>(steps_left);
  left -= kStepsPerCall;
  return left < 0 ? 1 : 0;
}

/// A file of others is read with these on: nothing in it is followed, and none of its rows can be
/// larger than the file.
void Database::distrust(const std::filesystem::path& file) {
  std::error_code unknown;
  const std::uintmax_t told = std::filesystem::file_size(file, unknown);
  const std::int64_t size =
      unknown ? 0 : static_cast<std::int64_t>(std::min<std::uintmax_t>(told, INT64_MAX / 64));
  sqlite3* const connection = connection_.get();
  constexpr std::int64_t kLeast = 1'000'000;
  constexpr std::int64_t kMost = 1'000'000'000;
  sql_->limit(connection, SQLITE_LIMIT_LENGTH, static_cast<int>(std::clamp(size, kLeast, kMost)));
  sql_->limit(connection, SQLITE_LIMIT_SQL_LENGTH, 100'000);
  sql_->limit(connection, SQLITE_LIMIT_COLUMN, 64);
  sql_->limit(connection, SQLITE_LIMIT_EXPR_DEPTH, 64);
  sql_->limit(connection, SQLITE_LIMIT_COMPOUND_SELECT, 8);
  sql_->limit(connection, SQLITE_LIMIT_TRIGGER_DEPTH, 1);
  sql_->limit(connection, SQLITE_LIMIT_ATTACHED, 0);
  steps_granted_ = kStepsOfAnyMap + kStepsPerByte * size;
  steps_left_ = std::make_unique<std::int64_t>(steps_granted_);
  sql_->progress_handler(connection, kStepsPerCall, &count_steps, steps_left_.get());
}

Database::Database(const std::filesystem::path& file, Mode mode, const MapKey& key)
    : sql_(key ? &cipher_sqlite() : &plain_sqlite()), connection_(nullptr, Close{sql_}) {
  const int access = mode == Mode::read    ? SQLITE_OPEN_READONLY
                     : mode == Mode::write ? SQLITE_OPEN_READWRITE
                                           : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* connection = nullptr;
  const int opened = sql_->open_v2(file.c_str(), &connection, access, nullptr);
  connection_.reset(connection);
  if (opened != SQLITE_OK) fail();
  if (key) set_key(key);
  sql_->extended_result_codes(connection, 1);
  sql_->busy_timeout(connection, kPatience_ms);
  sql_->db_config(connection, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  if (mode == Mode::read) distrust(file);
  run("PRAGMA trusted_schema = OFF");  // no function is called for what a file's schema asks
  run("PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0");
  run("PRAGMA temp_store = MEMORY");  // a file of its own would not be encrypted by every version
  if (mode == Mode::read) run("PRAGMA query_only = ON");
  if (key && mode != Mode::create) expect_right_key();
  if (mode == Mode::write) run("PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL");
  if (mode == Mode::create) run("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
}

/// By a function of its own: what is in no SQL text cannot be in the message of an error.
void Database::set_key(const MapKey& key) {
  run("PRAGMA cipher_log_level = NONE");  // 4.6 and later write to standard error what we tell
  const std::string_view bytes = key.bytes();
  if (sql_->key(connection_.get(), bytes.data(), static_cast<int>(bytes.size())) != SQLITE_OK) {
    throw Refused("SQLCipher does not take this key");
  }
  // Files stay readable whatever a later version does by default; version 3 ignores the first.
  run("PRAGMA cipher_compatibility = 3");
  run(fmt::format("PRAGMA cipher_page_size = {}", kCipherPage));
  if (!key.is_raw()) run(fmt::format("PRAGMA kdf_iter = {}", kCipherRounds));
}

/// The first page carries a code that only its key makes right.
void Database::expect_right_key() {
  const Statement statement = prepared_or_null("SELECT count(*) FROM sqlite_master");
  const int stepped = statement ? sql_->step(statement.get()) : SQLITE_ERROR;
  if (stepped != SQLITE_ROW) {
    if ((sql_->errcode(connection_.get()) & 0xFF) != SQLITE_NOTADB) fail();
    throw Refused(
        "does not open with this key: another one encrypts it (or it is no map file of ydd-slam, "
        "or "
        "its beginning was changed)");
  }
  if (number("PRAGMA application_id") != kApplicationId) {
    throw Refused("is an encrypted database of another program, not a map file of ydd-slam");
  }
  if (const std::int64_t version = number("PRAGMA user_version"); version > kVersion) {
    throw Refused(newer_version(version));
  }
}

void Database::fail() {
  const bool encrypted = sql_->key != nullptr;
  if (encrypted && connection_ && (sql_->errcode(connection_.get()) & 0xFF) == SQLITE_NOTADB) {
    throw Fault("a page of it does not carry its code");  // the key is right: the first one did
  }
  throw Fault(connection_ ? sql_->errmsg(connection_.get()) : "out of memory");
}

void Database::run(const std::string& sql) {
  if (sql_->exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

Database::Statement Database::prepared_or_null(const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  const int code = sql_->prepare_v2(connection_.get(), sql.c_str(), -1, &statement, nullptr);
  return {code == SQLITE_OK ? statement : nullptr, Close{sql_}};
}

Database::Statement Database::prepare(const std::string& sql) {
  Statement statement = prepared_or_null(sql);
  if (!statement) fail();
  return statement;
}

sqlite3_stmt& Database::prepared(const std::string& sql) {
  auto found = statements_.find(sql);
  if (found == statements_.end()) found = statements_.emplace(sql, prepare(sql)).first;
  return *found->second;
}

void Database::finish(sqlite3_stmt& statement) {
  const int stepped = sql_->step(&statement);
  sql_->reset(&statement);
  sql_->clear_bindings(&statement);
  if (stepped != SQLITE_DONE) fail();
}

std::int64_t Database::number(const std::string& sql) {
  const Statement statement = prepare(sql);
  if (sql_->step(statement.get()) != SQLITE_ROW) fail();
  return sql_->column_int64(statement.get(), 0);
}

std::string Database::text(const std::string& sql) {
  std::vector<std::string> all = texts(sql);
  if (all.empty()) throw Fault("no answer");
  return std::move(all.front());
}

std::vector<std::string> Database::texts(const std::string& sql) {
  const Statement statement = prepare(sql);
  std::vector<std::string> out;
  int stepped = sql_->step(statement.get());
  for (; stepped == SQLITE_ROW; stepped = sql_->step(statement.get())) {
    const auto* const text = sql_->column_text(statement.get(), 0);
    out.emplace_back(text ? reinterpret_cast<const char*>(text) : "");
  }
  if (stepped != SQLITE_DONE) fail();
  return out;
}

namespace {

std::string definition_of(const TableShape& table) {
  std::string sql = fmt::format("CREATE TABLE {}(key INTEGER PRIMARY KEY", table.name);
  for (const char* const column : table.columns) sql += fmt::format(", {}", column);
  return sql + ", checksum INTEGER)";
}

/// "key, ..., checksum FROM table".
std::string columns_of(const TableShape& table) {
  std::string sql = "key";
  for (const char* const column : table.columns) sql += fmt::format(", {}", column);
  return sql + fmt::format(", checksum FROM {}", table.name);
}

Fault wrong_checksum(const TableShape& table, std::int64_t key) {
  return Fault(fmt::format("table {}, row {}: checksum does not match", table.name, key));
}

std::string text_of(const SqliteLibrary& sql, sqlite3_stmt& statement, int column) {
  const auto* const text = sql.column_text(&statement, column);
  return text ? reinterpret_cast<const char*>(text) : "";
}

}  // namespace

void Database::create_table(const TableShape& table) { run(definition_of(table)); }

void Database::expect_tables(std::span<const TableShape* const> tables) {
  std::map<std::string, std::string> wanted;
  for (const TableShape* const table : tables) wanted[table->name] = definition_of(*table);
  const Statement statement = prepare("SELECT type, name, sql FROM sqlite_master");
  int stepped = sql_->step(statement.get());
  for (; stepped == SQLITE_ROW; stepped = sql_->step(statement.get())) {
    const std::string name = text_of(*sql_, *statement, 1);
    const auto found = wanted.find(name);
    if (text_of(*sql_, *statement, 0) != "table" || found == wanted.end() ||
        text_of(*sql_, *statement, 2) != found->second) {
      throw Fault(fmt::format("'{:.40}' in it is no table of a map", name));
    }
    wanted.erase(found);
  }
  if (stepped != SQLITE_DONE) fail();
  if (!wanted.empty()) throw Fault(fmt::format("table {} is missing", wanted.begin()->first));
}

void Database::put(const TableShape& table, const Row& row, std::uint64_t checksum) {
  std::string sql = fmt::format("INSERT OR REPLACE INTO {} VALUES (?", table.name);
  for (std::size_t i = 0; i <= table.columns.size(); ++i) sql += ", ?";
  sqlite3_stmt& statement = prepared(sql + ")");
  int index = 1;
  bool bound = sql_->bind_int64(&statement, index, row.key) == SQLITE_OK;
  for (const Value& value : row.values) {
    bound = bound && bind(*sql_, statement, ++index, value) == SQLITE_OK;
  }
  bound = bound &&
          sql_->bind_int64(&statement, ++index, static_cast<std::int64_t>(checksum)) == SQLITE_OK;
  if (!bound) fail();
  finish(statement);
}

void Database::erase(const TableShape& table, std::int64_t key) {
  sqlite3_stmt& statement = prepared(fmt::format("DELETE FROM {} WHERE key = ?", table.name));
  if (sql_->bind_int64(&statement, 1, key) != SQLITE_OK) fail();
  finish(statement);
}

void Database::for_each(const TableShape& table,
                        const std::function<void(const Row&, std::uint64_t)>& visit) {
  for_each_unchecked(table, [&](const Row& row, std::uint64_t stored) {
    if (checksum_of(table, row) != stored) throw wrong_checksum(table, row.key);
    visit(row, stored);
  });
}

void Database::renew_patience() {
  if (steps_left_) *steps_left_ = steps_granted_;
}

std::optional<Row> Database::find(const TableShape& table, std::int64_t key) {
  sqlite3_stmt& statement = prepared(fmt::format("SELECT {} WHERE key = ?", columns_of(table)));
  sql_->reset(&statement);  // the last look may have ended with a fault
  if (sql_->bind_int64(&statement, 1, key) != SQLITE_OK) fail();
  std::optional<Row> row;
  std::uint64_t stored = 0;
  const int stepped = sql_->step(&statement);
  if (stepped == SQLITE_ROW) {
    const int columns = static_cast<int>(table.columns.size());
    row = row_of(*sql_, statement, columns);
    stored = static_cast<std::uint64_t>(sql_->column_int64(&statement, columns + 1));
  } else if (stepped != SQLITE_DONE) {
    sql_->reset(&statement);
    fail();
  }
  sql_->reset(&statement);
  if (row && checksum_of(table, *row) != stored) throw wrong_checksum(table, row->key);
  return row;
}

void Database::for_each_unchecked(const TableShape& table,
                                  const std::function<void(const Row&, std::uint64_t)>& visit) {
  const Statement statement = prepare(fmt::format("SELECT {} ORDER BY key", columns_of(table)));
  const int columns = static_cast<int>(table.columns.size());
  int stepped = sql_->step(statement.get());
  for (; stepped == SQLITE_ROW; stepped = sql_->step(statement.get())) {
    const Row row = row_of(*sql_, *statement, columns);
    const auto stored =
        static_cast<std::uint64_t>(sql_->column_int64(statement.get(), columns + 1));
    visit(row, stored);
  }
  if (stepped != SQLITE_DONE) fail();
}

}  // namespace ydd::map_format
