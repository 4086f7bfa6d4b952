// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/video_file.h"

#include <dlfcn.h>
#include <unistd.h>

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/files.h"
#include "ydd/pictures/video_module/video_module.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModule = "libydd_video.so";

/// The functions of the module. It stays loaded: OpenCV does not like to be taken away.
struct Module {
  decltype(&ydd_video_open) open = nullptr;
  decltype(&ydd_video_add) add = nullptr;
  decltype(&ydd_video_close) close = nullptr;

  explicit Module(void* library)
      : open(find<decltype(open)>(library, "ydd_video_open")),
        add(find<decltype(add)>(library, "ydd_video_add")),
        close(find<decltype(close)>(library, "ydd_video_close")) {}
  bool complete() const { return open && add && close; }

 private:
  template <class Function>
  static Function find(void* library, const char* name) {
    return reinterpret_cast<Function>(::dlsym(library, name));
  }
};

Result<Module> load_module(const fs::path& file) {
  void* const library = ::dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
  if (library) {
    const Module module(library);
    if (module.complete()) return module;
  }
  const char* const reason = ::dlerror();
  return Error{fmt::format("{}: {} cannot be loaded ({}); --frames DIR leaves pictures instead",
                           file.string(), kModule, reason ? reason : "not of this version")};
}

}  // namespace

struct VideoFile::State {
  fs::path file;
  FreshFile unfinished;
  Module module;
  int width_px = 0, height_px = 0;
  void* encoder = nullptr;

  void close() {
    if (encoder) module.close(std::exchange(encoder, nullptr));
  }
  ~State() { close(); }
};

VideoFile::VideoFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoFile::VideoFile(VideoFile&&) noexcept = default;
VideoFile& VideoFile::operator=(VideoFile&&) noexcept = default;
VideoFile::~VideoFile() = default;

Result<VideoFile> VideoFile::open(const fs::path& file, int width_px, int height_px,
                                  double frames_per_second) {
  if (file.extension() != ".mp4") {
    return Error{fmt::format("{}: videos are MP4 files; name it *.mp4", file.string())};
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (::access(folder.c_str(), W_OK) != 0) {
    return Error{fmt::format("{}: cannot write into folder {}", file.string(), folder.string())};
  }
  const Result<Module> module = load_module(file);
  if (!module) return module.error();
  Result<FreshFile> unfinished = FreshFile::make(follow_links(file), ".mp4");
  if (!unfinished) return unfinished.error();
  std::unique_ptr<State> state(
      new State{file, std::move(*unfinished), *module, width_px, height_px, nullptr});
  state->encoder =
      module->open(state->unfinished.path().c_str(), width_px, height_px, frames_per_second);
  if (!state->encoder) {
    return Error{
        fmt::format("{}: this OpenCV has no encoder for MP4 (H.264 or MPEG-4); --frames "
                    "DIR leaves pictures instead",
                    file.string())};
  }
  return VideoFile(std::move(state));
}

Result<void> VideoFile::add(const ColourImage& picture) {
  if (picture.width() != state_->width_px || picture.height() != state_->height_px) {
    throw std::logic_error("VideoFile: pictures of one video have one size");
  }
  if (state_->module.add(state_->encoder, picture.data()->data())) return {};
  return Error{fmt::format("{}: a frame could not be written", state_->file.string())};
}

Result<void> VideoFile::finish() {
  state_->close();
  return state_->unfinished.place();
}

}  // namespace ydd
