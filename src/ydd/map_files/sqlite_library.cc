// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/sqlite_library.h"

#include <dlfcn.h>

#include <cstring>
#include <string_view>

#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_key.h"

namespace ydd::map_format {
namespace {

constexpr std::string_view kMissing =
    "encrypted maps need SQLCipher: install libsqlcipher0 (Debian 12) or libsqlcipher1 (Debian 13) "
    "for the same program to use";
constexpr std::string_view kOther =
    "encrypted maps need SQLCipher: the libsqlcipher that was found lacks its functions";
[[maybe_unused]] constexpr std::string_view kSanitized =
    "encrypted maps need SQLCipher, which cannot be loaded into a build with sanitizers";

constexpr SqliteLibrary kPlain = {
#define YDD_LINKED(name) &::sqlite3_##name,
    YDD_SQLITE_FUNCTIONS(YDD_LINKED)
#undef YDD_LINKED
        nullptr};

struct Loaded {
  SqliteLibrary functions{};
  std::string_view missing;  ///< empty: nothing is
};

/// Of the versions that there are, the functions that we use are the same.
constexpr const char* kFiles[] = {"libsqlcipher.so.1", "libsqlcipher.so.0"};

/// Without RTLD_DEEPBIND the library's calls of its own functions would end in libsqlite3, which is
/// there already: `sqlite3_open_v2` of one and `sqlite3_step` of the other.
[[maybe_unused]] Loaded load() {
  void* handle = nullptr;
  for (const char* const file : kFiles) {
    if (handle == nullptr) handle = ::dlopen(file, RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
  }
  if (handle == nullptr) return {{}, kMissing};  // stays loaded for as long as the program runs
  Loaded out;
  bool all = true;
  const auto find = [&](auto& function, const char* name) {
    void* const found = ::dlsym(handle, name);
    static_assert(sizeof(found) == sizeof(function));
    std::memcpy(&function, &found, sizeof(found));
    all = all && found != nullptr;
  };
  SqliteLibrary& f = out.functions;
#define YDD_LOADED(name) find(f.name, "sqlite3_" #name);
  YDD_SQLITE_FUNCTIONS(YDD_LOADED)
#undef YDD_LOADED
  find(f.key, "sqlite3_key");
  if (!all || f.open_v2 == kPlain.open_v2) out.missing = kOther;
  return out;
}

const Loaded& cipher() {
#ifdef YDD_SANITIZED
  static const Loaded loaded = {{}, kSanitized};
#else
  static const Loaded loaded = load();
#endif
  return loaded;
}

}  // namespace

const SqliteLibrary& plain_sqlite() { return kPlain; }

const SqliteLibrary& cipher_sqlite() {
  if (!cipher().missing.empty()) throw Refused(std::string(cipher().missing));
  return cipher().functions;
}

}  // namespace ydd::map_format

namespace ydd {

std::string_view why_no_encryption() { return map_format::cipher().missing; }

}  // namespace ydd
