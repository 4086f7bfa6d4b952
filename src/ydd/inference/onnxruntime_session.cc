// SPDX-License-Identifier: Apache-2.0
// ONNX Runtime through the one function that its shared library exports, OrtGetApiBase. The table
// of functions behind it only ever grows at its end, so the places of the few that are used here
// hold for every version of the library; its header is not needed, and a program that was built
// without the library finds it when it runs (docs/adr/0007-inference-back-ends.md).
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>

#include "ydd/inference/network_backends.h"
#include "ydd/inference/onnx_graph.h"

namespace ydd {
namespace {

/// Version of the table that is asked for: old enough for every library of the last years.
constexpr std::uint32_t kTableVersion = 11;

/// Places in the table of functions.
// NOLINTBEGIN(readability-identifier-naming): named as in ONNX Runtime's header
enum Entry : std::size_t {
  kGetErrorMessage = 2,
  kCreateEnv = 3,
  kCreateSessionFromArray = 8,
  kRun = 9,
  kCreateSessionOptions = 10,
  kSetIntraOpNumThreads = 24,
  kSetInterOpNumThreads = 25,
  kCreateTensorWithData = 49,
  kGetTensorMutableData = 51,
  kGetTensorElementType = 60,
  kGetDimensionsCount = 61,
  kGetDimensions = 62,
  kGetTensorTypeAndShape = 65,
  kCreateCpuMemoryInfo = 69,
  kReleaseEnv = 92,
  kReleaseStatus = 93,
  kReleaseMemoryInfo = 94,
  kReleaseSession = 95,
  kReleaseValue = 96,
  kReleaseShape = 99,
  kReleaseSessionOptions = 100,
};
// NOLINTEND(readability-identifier-naming)

constexpr int kFatalMessagesOnly = 4;
constexpr int kFloatTensor = 1;
constexpr int kArenaAllocator = 1;
constexpr int kDefaultMemory = 0;

using Opaque = void*;
using Status = Opaque;  // null: success

struct ApiBase {
  const Opaque* (*table)(std::uint32_t version);
  const char* (*version)();
};

class Library {
 public:
  static Result<Library> open(const std::string& named) {
    const std::string file = named.empty() ? "libonnxruntime.so.1" : named;
    void* const handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
      return Error{
          fmt::format("ONNX Runtime cannot be loaded: {}; name libonnxruntime.so.1 in "
                      "'onnxruntime', or use 'backend: opencv'",
                      dlerror())};
    }
    const auto base = reinterpret_cast<const ApiBase* (*)()>(dlsym(handle, "OrtGetApiBase"));
    const Opaque* table = base == nullptr ? nullptr : base()->table(kTableVersion);
    if (table == nullptr) {
      return Error{file + ": is not ONNX Runtime 1.11 or newer"};
    }
    return Library(table, handle);
  }

  template <class Function>
  Function entry(Entry place) const {
    return reinterpret_cast<Function>(table_[place]);
  }

  /// Calls a function that can fail.
  template <class... Arguments>
  Result<void> call(Entry place, Arguments... arguments) const {
    return checked(entry<Status (*)(Arguments...)>(place)(arguments...));
  }

  Result<void> checked(Status status) const {
    if (status == nullptr) return {};
    std::string reason = entry<const char* (*)(Status)>(kGetErrorMessage)(status);
    entry<void (*)(Status)>(kReleaseStatus)(status);
    for (char& c : reason) c = c == '\n' ? ' ' : c;
    return Error{reason.substr(0, 300)};
  }

  /// Lets sessions of `session_options` compute on the first GPU. By the one function for it that
  /// builds with CUDA have exported since their first version, beside the table.
  Result<void> add_cuda(Opaque session_options) const {
    const auto add = reinterpret_cast<Status (*)(Opaque, int)>(
        dlsym(handle_, "OrtSessionOptionsAppendExecutionProvider_CUDA"));
    if (add == nullptr) return Error{"this ONNX Runtime was built without CUDA"};
    return checked(add(session_options, 0));
  }

  void release(Entry place, Opaque what) const {
    if (what != nullptr) entry<void (*)(Opaque)>(place)(what);
  }

 private:
  Library(const Opaque* table, void* handle) : table_(table), handle_(handle) {}
  const Opaque* table_;  // as long as the process: the library stays loaded
  void* handle_;
};

/// Something that the library made, given back at the end.
class Handle {
 public:
  Handle(const Library& library, Entry release) : library_(library), release_(release) {}
  ~Handle() { library_.release(release_, what_); }
  Handle(Handle&& other) noexcept
      : library_(other.library_), release_(other.release_), what_(std::exchange(other.what_, {})) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;

  Opaque get() const { return what_; }
  Opaque* place() { return &what_; }

 private:
  Library library_;
  Entry release_;
  Opaque what_ = nullptr;
};

class OnnxRuntimeSession : public InferenceSession {
 public:
  static SessionResult make(const Library& library, std::string_view onnx,
                            const InferenceOptions& wanted, std::vector<std::string> input_names,
                            std::vector<std::string> output_names) {
    std::unique_ptr<OnnxRuntimeSession> out(new OnnxRuntimeSession(library));
    out->input_names_ = std::move(input_names);
    out->output_names_ = std::move(output_names);
    out->device_ = to_string(wanted.device);
    if (auto made = out->start(onnx, wanted); !made) {
      return Error{"ONNX Runtime cannot load it: " + made.error().message};
    }
    return std::unique_ptr<InferenceSession>(std::move(out));
  }

  Result<std::vector<Tensor>> run(const Tensor& input) override {
    Result<std::vector<Tensor>> outputs = run_once(input);
    if (outputs) return outputs;
    return Error{fmt::format("cannot take an input of {}: {}", format_shape(input.shape),
                             outputs.error().message)};
  }
  std::string device() const override { return device_; }

 private:
  explicit OnnxRuntimeSession(const Library& library)
      : library_(library),
        environment_(library, kReleaseEnv),
        memory_(library, kReleaseMemoryInfo),
        session_(library, kReleaseSession) {}

  Result<void> start(std::string_view onnx, const InferenceOptions& wanted) {
    Handle options(library_, kReleaseSessionOptions);
    const char* const name = "ydd";
    if (auto r = library_.call(kCreateEnv, kFatalMessagesOnly, name, environment_.place()); !r) {
      return r;
    }
    if (auto r = library_.call(kCreateSessionOptions, options.place()); !r) return r;
    for (const Entry entry : {kSetIntraOpNumThreads, kSetInterOpNumThreads}) {
      if (auto r = library_.call(entry, options.get(), wanted.threads); !r) return r;
    }
    if (wanted.device == Device::cuda) {
      if (auto r = library_.add_cuda(options.get()); !r) return r;
    }
    const auto* const model = static_cast<const void*>(onnx.data());
    if (auto r = library_.call(kCreateSessionFromArray, environment_.get(), model, onnx.size(),
                               options.get(), session_.place());
        !r) {
      return r;
    }
    return library_.call(kCreateCpuMemoryInfo, kArenaAllocator, kDefaultMemory, memory_.place());
  }

  Result<std::vector<Tensor>> run_once(const Tensor& input) {
    const std::vector<std::int64_t> dims(input.shape.begin(), input.shape.end());
    Handle value(library_, kReleaseValue);
    // The library only reads it, but its interface cannot say so.
    auto* const data = static_cast<void*>(const_cast<float*>(input.values.data()));
    if (auto r =
            library_.call(kCreateTensorWithData, memory_.get(), data, input.values.size_bytes(),
                          dims.data(), dims.size(), kFloatTensor, value.place());
        !r) {
      return r.error();
    }
    const std::array<const char*, 1> inputs = {input_names_.front().c_str()};
    const std::array<Opaque, 1> values = {value.get()};
    std::vector<const char*> names;
    for (const std::string& name : output_names_) names.push_back(name.c_str());
    std::vector<Opaque> made(names.size(), nullptr);
    const Result<void> ran =
        library_.call(kRun, session_.get(), Opaque{}, inputs.data(), values.data(), values.size(),
                      names.data(), names.size(), made.data());
    outputs_.clear();
    for (Opaque one : made) {
      outputs_.emplace_back(library_, kReleaseValue);
      *outputs_.back().place() = one;
    }
    if (!ran) return ran.error();
    return views();
  }

  Result<std::vector<Tensor>> views() const {
    std::vector<Tensor> tensors;
    for (const Handle& output : outputs_) {
      Result<Tensor> tensor = view(output.get());
      if (!tensor) return tensor.error();
      tensors.push_back(std::move(*tensor));
    }
    return tensors;
  }

  Result<Tensor> view(Opaque output) const {
    Handle shape(library_, kReleaseShape);
    int type = 0;
    std::size_t count = 0;
    if (auto r = library_.call(kGetTensorTypeAndShape, output, shape.place()); !r) return r.error();
    if (auto r = library_.call(kGetTensorElementType, shape.get(), &type); !r) return r.error();
    if (type != kFloatTensor) return Error{"gives something else than 32-bit floats"};
    if (auto r = library_.call(kGetDimensionsCount, shape.get(), &count); !r) return r.error();
    std::vector<std::int64_t> dims(count);
    if (auto r = library_.call(kGetDimensions, shape.get(), dims.data(), count); !r) {
      return r.error();
    }
    float* values = nullptr;
    if (auto r = library_.call(kGetTensorMutableData, output, &values); !r) return r.error();
    Tensor tensor;
    for (const std::int64_t d : dims) tensor.shape.push_back(static_cast<int>(d));
    const auto size =
        std::accumulate(dims.begin(), dims.end(), std::int64_t{1}, std::multiplies<>());
    tensor.values = {values, static_cast<std::size_t>(size)};
    return tensor;
  }

  Library library_;
  std::vector<std::string> input_names_, output_names_;
  std::string device_;
  Handle environment_, memory_, session_;  // destroyed from the last to the first
  std::vector<Handle> outputs_;
};

}  // namespace

SessionResult make_onnxruntime_session(std::string_view onnx, const InferenceOptions& options) {
  if (options.precision == Precision::bfloat16 || options.precision == Precision::int8) {
    return Error{fmt::format("precision {} needs 'backend: onednn'", to_string(options.precision))};
  }
  if (options.precision == Precision::float16)
    return Error{"precision float16 needs 'backend: opencv' and 'device: cuda'"};
  const Result<Library> library = Library::open(options.onnxruntime);
  if (!library) return library.error();
  const Result<OnnxGraph> graph = read_onnx(onnx);
  if (!graph) return Error{"ONNX Runtime cannot load it: " + graph.error().message};
  if (graph->inputs.size() != 1 || graph->outputs.empty()) {
    return Error{"has more than one input, or none, or no output"};
  }
  return OnnxRuntimeSession::make(*library, onnx, options, graph->inputs, graph->outputs);
}

}  // namespace ydd
