// SPDX-License-Identifier: Apache-2.0
#include <system_error>

#include <fmt/format.h>

#include "ydd/base/file_lock.h"
#include "ydd/base/files.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_header.h"
#include "ydd/map_files/map_rows.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using map_format::Database;
using map_format::Fault;

/// The other name must be free, or be one of the same file.
void expect_free(const fs::path& file, const fs::path& out) {
  std::error_code ignored;
  if (fs::equivalent(file, out, ignored) || !fs::exists(fs::symlink_status(out))) return;
  throw Fault(fmt::format("{} is there already; name another file or move that", out.string()));
}

void write_new(const Atlas& atlas, const fs::path& file, const MapKey& key) {
  map_format::HeldRows rows;
  Database database(file, Database::Mode::create, key);
  database.run("BEGIN");
  map_format::make_schema(database);
  map_format::write_rows(database, atlas, nullptr, rows);
  database.run("COMMIT");
}

}  // namespace

Result<void> convert_map(const fs::path& file, const MapKey& key, const fs::path& out,
                         const MapKey& out_key) {
  try {
    if (out_key) (void)map_format::cipher_sqlite();  // before anything is read
    const fs::path from = map_file_target(file);
    const fs::path to = map_file_target(out);
    map_format::check_header(from, key);
    map_format::recover(from, key);  // which the lock would keep load_map from
    const Result<FileLock> lock = FileLock::take(from, false);
    if (!lock) throw Fault(lock.error().message);
    const Result<Atlas> atlas = load_map(from, key);
    if (!atlas) return atlas.error();
    expect_free(from, to);
    Result<FreshFile> fresh = FreshFile::make(to, ".new");
    if (!fresh) return fresh.error();
    write_new(*atlas, fresh->path(), out_key);
    if (Result<void> placed = fresh->place(); !placed) return placed;  // flushes it
    flush_folder(to.has_parent_path() ? to.parent_path() : fs::path("."));
    return {};
  } catch (const std::exception& fault) {
    return Error{fmt::format("{}: {}", file.string(), fault.what())};
  }
}

}  // namespace ydd
