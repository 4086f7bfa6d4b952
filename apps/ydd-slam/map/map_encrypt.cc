// SPDX-License-Identifier: Apache-2.0
// Map files that get a key, another one, or none.
#include <fmt/format.h>

#include "map/map_jobs.h"
#include "ydd/map_files/map_file.h"

namespace ydd::app {
namespace {

Result<MapKey> wanted_key(const MapConvertRequest& request) {
  Result<MapKey> key = MapKey::find(request.map_key);
  if (key && !*key) return Error{"--map-key: name the file with the key of the map"};
  return key;
}

Result<void> convert(const MapConvertRequest& request, const MapKey& from, const MapKey& to,
                     const char* done) {
  const std::string& out = request.out.empty() ? request.file : request.out;
  if (auto r = convert_map(request.file, from, out, to); !r) return r;
  fmt::print("{}: {}\n", out, done);
  return {};
}

}  // namespace

Result<void> map_encrypt(const MapConvertRequest& request) {
  const Result<MapKey> key = wanted_key(request);
  if (!key) return key.error();
  const Result<MapKey> old =
      request.old_key.empty() ? Result(MapKey()) : MapKey::read(request.old_key);
  if (!old) return old.error();
  return convert(request, *old, *key, *old ? "has another key" : "is encrypted");
}

Result<void> map_decrypt(const MapConvertRequest& request) {
  const Result<MapKey> key = wanted_key(request);
  if (!key) return key.error();
  return convert(request, *key, {}, "is plain, not encrypted any more");
}

}  // namespace ydd::app
