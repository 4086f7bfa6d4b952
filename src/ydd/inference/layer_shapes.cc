// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/layer_shapes.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

namespace ydd {
namespace {

using Wide = std::int64_t;  // sizes of others' files are multiplied: 32 bits would overflow

int windowed(int size, const Window& w, std::size_t axis) {
  const Wide reach = (Wide{w.kernel[axis]} - 1) * w.dilation[axis] + 1;
  const Wide room = Wide{size} + w.pad_begin[axis] + w.pad_end[axis] - reach;
  if (room < 0) throw std::runtime_error("it is smaller than a window of the network");
  return static_cast<int>(room / w.stride[axis] + 1);
}

/// A map with sizes that are checked.
MapShape checked(Wide channels, Wide rows, Wide columns) {
  constexpr Wide kMost = Wide{1} << 28U;
  if (channels < 1 || rows < 1 || columns < 1 || channels > kMost || rows > kMost / channels ||
      columns > kMost / (channels * rows)) {
    throw std::runtime_error("a map of the network would be too large");
  }
  return {static_cast<int>(channels), static_cast<int>(rows), static_cast<int>(columns)};
}

MapShape after_concat(const std::vector<MapShape>& inputs) {
  const MapShape& first = inputs.front();
  Wide channels = 0;
  for (const MapShape& s : inputs) {
    if (s.rows != first.rows || s.columns != first.columns) {
      throw std::runtime_error("maps of different sizes would have to be put together");
    }
    channels += s.channels;
  }
  return checked(channels, first.rows, first.columns);
}

MapShape after(const Layer& layer, const std::vector<MapShape>& inputs) {
  MapShape out = inputs.front();
  switch (layer.kind) {
    case LayerKind::convolution:
      if (layer.weights.dims[1] * layer.groups != out.channels) {
        throw std::runtime_error("the channels do not fit the network");
      }
      out.channels = static_cast<int>(layer.weights.dims[0]);
      [[fallthrough]];
    case LayerKind::max_pool:
      return checked(out.channels, windowed(out.rows, layer.window, 0),
                     windowed(out.columns, layer.window, 1));
    case LayerKind::upsample:
      return checked(out.channels, Wide{out.rows} * layer.scale, Wide{out.columns} * layer.scale);
    case LayerKind::concat:
      return after_concat(inputs);
    case LayerKind::add:
    case LayerKind::multiply:
      if (inputs[0] != inputs[1])
        throw std::runtime_error("maps of different sizes would be joined");
      return out;
    case LayerKind::activation:
      return out;
  }
  throw std::logic_error("map_shapes: not a LayerKind");
}

/// First fit in one block of memory.
class Arena {
 public:
  std::size_t take(std::size_t size) {
    constexpr std::size_t kLine = 64;
    size = (size + kLine - 1) / kLine * kLine;
    std::size_t offset = 0;
    auto at = live_.begin();
    for (; at != live_.end() && at->offset < offset + size; ++at) offset = at->offset + at->size;
    live_.insert(at, {offset, size});
    size_ = std::max(size_, offset + size);
    return offset;
  }
  void give_back(std::size_t offset) {
    std::erase_if(live_, [&](const Block& b) { return b.offset == offset; });
  }
  std::size_t size() const { return size_; }

 private:
  struct Block {
    std::size_t offset, size;
  };
  std::vector<Block> live_;  // by offset
  std::size_t size_ = 0;
};

}  // namespace

std::vector<MapShape> map_shapes(const LayerGraph& graph, const MapShape& input) {
  std::vector<MapShape> shapes(static_cast<std::size_t>(graph.value_count));
  shapes[0] = checked(input.channels, input.rows, input.columns);
  for (const Layer& layer : graph.layers) {
    std::vector<MapShape> inputs;
    for (const int value : layer.inputs) inputs.push_back(shapes[static_cast<std::size_t>(value)]);
    const MapShape out = after(layer, inputs);
    if (layer.residual && shapes[static_cast<std::size_t>(*layer.residual)] != out) {
      throw std::runtime_error("maps of different sizes would be added");
    }
    shapes[static_cast<std::size_t>(layer.output)] = out;
  }
  return shapes;
}

std::vector<bool> wide_values(const LayerGraph& graph) {
  std::vector<bool> wide(static_cast<std::size_t>(graph.value_count), false);
  std::vector<int> readers(static_cast<std::size_t>(graph.value_count), 0);
  std::vector<bool> convolved(static_cast<std::size_t>(graph.value_count), false);
  for (const Layer& layer : graph.layers) {
    for (const int input : layer.inputs) ++readers[static_cast<std::size_t>(input)];
    convolved[static_cast<std::size_t>(layer.output)] =
        layer.kind == LayerKind::convolution && !layer.residual;
  }
  const auto may_be = [&](int value) {
    return convolved[static_cast<std::size_t>(value)] &&
           readers[static_cast<std::size_t>(value)] <= 1;
  };
  for (const int output : graph.outputs) {
    const auto its = std::find_if(graph.layers.begin(), graph.layers.end(),
                                  [&](const Layer& layer) { return layer.output == output; });
    if (its == graph.layers.end() || readers[static_cast<std::size_t>(output)] > 0) continue;
    if (its->kind == LayerKind::concat &&
        std::all_of(its->inputs.begin(), its->inputs.end(), may_be)) {
      for (const int input : its->inputs) wide[static_cast<std::size_t>(input)] = true;
      wide[static_cast<std::size_t>(output)] = true;
    }
    if (may_be(output)) wide[static_cast<std::size_t>(output)] = true;
  }
  return wide;
}

ValuePlaces place_values(const LayerGraph& graph, const std::vector<std::size_t>& value_bytes) {
  const std::vector<int> last = last_uses(graph);
  std::vector<std::size_t> offsets(value_bytes.size(), 0);
  Arena arena;
  const auto place = [&](int value) {
    offsets[static_cast<std::size_t>(value)] =
        arena.take(value_bytes[static_cast<std::size_t>(value)]);
  };
  place(0);
  for (int i = 0; i < static_cast<int>(graph.layers.size()); ++i) {
    const Layer& layer = graph.layers[static_cast<std::size_t>(i)];
    if (layer.residual) {
      offsets[static_cast<std::size_t>(layer.output)] =
          offsets[static_cast<std::size_t>(*layer.residual)];
    } else {
      place(layer.output);
    }
    std::vector<int> done = layer.inputs;
    std::sort(done.begin(), done.end());
    done.erase(std::unique(done.begin(), done.end()), done.end());
    for (const int value : done) {
      if (last[static_cast<std::size_t>(value)] == i) {
        arena.give_back(offsets[static_cast<std::size_t>(value)]);
      }
    }
  }
  return {offsets, arena.size()};
}

}  // namespace ydd
