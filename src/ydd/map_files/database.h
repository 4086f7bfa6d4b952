// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ydd/map_files/map_key.h"
#include "ydd/map_files/sqlite_library.h"

/// SQLite as map files use it. Inside the room only; every failure throws map_format::Fault.
namespace ydd::map_format {

/// A cell: a whole number or bytes. (SQLite rounds -0.0 to 0.0, so other numbers go into bytes.)
using Value = std::variant<std::int64_t, std::string>;

/// One row: its key and the cells after it.
struct Row {
  std::int64_t key = 0;
  std::vector<Value> values;

  std::int64_t integer(std::size_t i) const;
  /// A whole number from 0 to `largest`.
  std::uint32_t number(std::size_t i, std::uint32_t largest = UINT32_MAX) const;
  const std::string& bytes(std::size_t i) const;
};

/// What a table is called, and its columns between the key and the checksum.
struct TableShape {
  const char* name;
  std::vector<const char*> columns;
};

/// Of a row in its table.
std::uint64_t checksum_of(const TableShape& table, const Row& row);

/// One connection. Thread: one call at a time.
class Database {
 public:
  enum class Mode {
    read,    ///< cannot change the file, which is not trusted
    write,   ///< commits survive a power cut
    create,  ///< new file, filled without a journal: of no use until it is complete
  };
  /// With a key the file is one of SQLCipher, else one of SQLite. @throws Refused where it does not
  /// open with this key, or holds no map that this program knows.
  Database(const std::filesystem::path& file, Mode mode, const MapKey& key = {});

  void run(const std::string& sql);
  /// First cell of the first row of the answer.
  std::int64_t number(const std::string& sql);
  std::string text(const std::string& sql);
  /// First cell of each row of the answer.
  std::vector<std::string> texts(const std::string& sql);

  void create_table(const TableShape& table);
  /// @throws Fault where the file has other tables than these, or anything else: a view, an index,
  /// a trigger, a column that is computed. To be asked before anything else is read.
  void expect_tables(std::span<const TableShape* const> tables);
  /// Inserts the row, or replaces the one with its key. `checksum` is checksum_of(table, row).
  void put(const TableShape& table, const Row& row, std::uint64_t checksum);
  void erase(const TableShape& table, std::int64_t key);
  /// Calls `visit(row, checksum)` in the order of keys. @throws Fault at a row whose checksum is
  /// wrong.
  void for_each(const TableShape& table,
                const std::function<void(const Row&, std::uint64_t)>& visit);
  /// The same whether the checksum is right or wrong: `visit` gets the one that is stored.
  void for_each_unchecked(const TableShape& table,
                          const std::function<void(const Row&, std::uint64_t)>& visit);
  /// The row of that key, if there is one. @throws Fault if its checksum is wrong.
  std::optional<Row> find(const TableShape& table, std::int64_t key);
  /// Counts the work that a file asks for anew: for a connection that stays open.
  void renew_patience();

 private:
  struct Close {
    const SqliteLibrary* sql;
    void operator()(sqlite3* connection) const;
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Close>;

  static int count_steps(void* steps_left);
  void set_key(const MapKey& key);
  void expect_right_key();
  void distrust(const std::filesystem::path& file);
  Statement prepared_or_null(const std::string& sql);
  Statement prepare(const std::string& sql);
  sqlite3_stmt& prepared(const std::string& sql);
  void finish(sqlite3_stmt& statement);
  [[noreturn]] void fail();

  std::int64_t steps_granted_ = 0;
  const SqliteLibrary* sql_;
  std::unique_ptr<std::int64_t> steps_left_;  ///< of a file that is read; outlives the connection
  std::unique_ptr<sqlite3, Close> connection_;
  std::map<std::string, Statement> statements_;  ///< those used again and again, by their text
};

}  // namespace ydd::map_format
