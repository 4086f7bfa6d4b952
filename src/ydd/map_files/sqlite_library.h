// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>

/// The two libraries that open map files. Inside the room only.
///
/// SQLCipher is a copy of SQLite whose functions have the same names. To link both would leave it
/// to the order of libraries whose function is called, also inside of them
/// (docs/adr/0014-encrypted-maps.md); so whatever works on a database calls through a table.
namespace ydd::map_format {

// The functions that are called, once for the table, for what is linked and for what is loaded.
// clang-format off
#define YDD_SQLITE_FUNCTIONS(FUNCTION) \
  FUNCTION(open_v2) FUNCTION(close_v2) FUNCTION(errcode) FUNCTION(errmsg) \
  FUNCTION(extended_result_codes) FUNCTION(busy_timeout) FUNCTION(db_config) FUNCTION(limit) \
  FUNCTION(progress_handler) FUNCTION(exec) FUNCTION(prepare_v2) FUNCTION(step) \
  FUNCTION(reset) FUNCTION(finalize) FUNCTION(clear_bindings) FUNCTION(bind_int64) \
  FUNCTION(bind_blob64) FUNCTION(column_type) FUNCTION(column_int64) FUNCTION(column_blob) \
  FUNCTION(column_bytes) FUNCTION(column_text)
// clang-format on

/// Functions of SQLite; what they do is in SQLite's documentation.
struct SqliteLibrary {
#define YDD_DECLARE(name) decltype(&::sqlite3_##name) name;  // NOLINT: a name takes no brackets
  YDD_SQLITE_FUNCTIONS(YDD_DECLARE)
#undef YDD_DECLARE
  /// SQLCipher's alone; null in the other.
  int (*key)(sqlite3* connection, const void* bytes, int size);
};

/// What this program is linked with.
const SqliteLibrary& plain_sqlite();
/// SQLCipher, loaded when it is asked for first. @throws Refused where it is missing.
const SqliteLibrary& cipher_sqlite();

}  // namespace ydd::map_format
