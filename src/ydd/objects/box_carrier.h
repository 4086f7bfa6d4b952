// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/detection/detection.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/image/rgbd_frame.h"

namespace ydd {

/// How a box is believed to move between two results.
enum class BoxMotion { flow, constant, none };
constexpr std::array<std::string_view, 3> choices_of(BoxMotion) {
  return {"flow", "constant", "none"};
}

/// How boxes get from the frame in which a detector saw them to the newest one.
struct CarryOptions {
  BoxMotion motion = BoxMotion::flow;
  int missed = 2;        ///< results without it that a person survives
  int seen = 2;          ///< results with it that make a person worth that
  double overlap = 0.3;  ///< intersection over union that makes two boxes the same thing
  void describe(OptionTable& table);
};

/// Boxes of the newest frame out of results that belong to earlier ones, for a detector that is
/// slower than the camera. Each box moves with what is in it: by the median optical flow (pyramidal
/// Lucas-Kanade on a picture of 160 px width) of points at the depth of its nearest surface, and
/// grows as that comes nearer. A side on the border of the picture stays there while the box moves
/// in: the rest of the thing follows. A person that a result lacks is carried on for a while.
///
/// Data in, data out; the same calls give the same boxes. Thread: one.
class BoxCarrier {
 public:
  /// Persons are what `catalogue` says.
  explicit BoxCarrier(const CarryOptions& options,
                      ObjectCatalogue catalogue = ObjectCatalogue::defaults());
  ~BoxCarrier();
  BoxCarrier(BoxCarrier&&) noexcept;
  BoxCarrier& operator=(BoxCarrier&&) noexcept;

  /// A new frame; all boxes move to it. Pictures are kept until a result for them or for a later
  /// frame has come. @throws std::logic_error unless indices rise.
  void advance(const RgbdFrame& frame);

  /// What the detector saw in the frame with this index, carried to the newest frame. A frame that
  /// is not kept any more is taken for the oldest one that is.
  void take(std::int64_t frame_index, const Detections& found);

  /// Boxes in the newest frame, by falling score, cut to the picture.
  Detections now() const;

 private:
  struct Picture;  // small grey picture and depth of one frame
  struct Carried {
    Detection detection;
    float dx_px = 0, dy_px = 0;  // per frame, of the last step
    int seen = 1;                // results with it
    int missed = 0;              // results without it since
  };
  struct Flow {  // of what is in one box
    bool known = false;
    float dx_px = 0, dy_px = 0, growth = 1;
  };
  static std::vector<Flow> flows_of(const std::vector<Carried>& objects, const Picture& from,
                                    const Picture& to);
  static Flow summary(std::vector<float> dx, std::vector<float> dy, std::vector<float> nearer);
  /// Moves `objects` from one picture to the next.
  void move(std::vector<Carried>& objects, const Picture& from, const Picture& to) const;
  std::vector<Carried> carried(const std::vector<Carried>& objects, std::size_t from_picture) const;
  std::vector<Carried> received(std::int64_t frame_index, const Detections& found);
  /// For each of `fresh` the index of the same object in `known`, or -1.
  std::vector<int> known_as(const std::vector<Carried>& fresh,
                            const std::vector<Carried>& known) const;
  void set_velocities(std::vector<Carried>& fresh, int frames) const;

  CarryOptions options_;
  ObjectCatalogue catalogue_;
  std::vector<Picture> pictures_;  // by rising index
  std::vector<Carried> objects_;   // in the newest frame
  std::vector<Carried> last_result_;
  std::int64_t last_result_frame_ = -1;
};

}  // namespace ydd
