// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "ydd/base/channel.h"
#include "ydd/base/guard.h"
#include "ydd/base/options.h"
#include "ydd/base/timing.h"
#include "ydd/detection/detector.h"
#include "ydd/objects/box_carrier.h"

namespace ydd {

/// Whether every frame waits for its boxes, or gets older ones carried on to it.
enum class DetectMode { automatic, every_frame, asynchronous };
constexpr std::array<std::string_view, 3> choices_of(DetectMode) {
  return {"auto", "every-frame", "asynchronous"};
}

/// When frames get boxes.
struct DetectOptions {
  DetectMode mode =
      DetectMode::automatic;  ///< which is every-frame, unless the application decides
  int latency_frames = 0;
  CarryOptions carry;
  void describe(OptionTable& table);
  /// Whether frames get older boxes, carried on to them.
  bool asynchronous() const { return mode == DetectMode::asynchronous; }
};

/// A detector in a thread of its own, so that it works beside feature extraction. Every frame given
/// to `start` is answered by one `join`, in order: results belong to their frame. What the detector
/// throws is its answer's error.
class DetectorRunner {
 public:
  /// What the detector saw in a frame.
  struct Answer {
    std::int64_t frame = 0;                        ///< index
    Result<Detections> detections = Detections{};  ///< what the detector said
    StageTime time;                                ///< of the detector, for this frame
  };

  explicit DetectorRunner(std::unique_ptr<Detector> detector);  ///< Starts its thread.
  ~DetectorRunner();
  DetectorRunner(const DetectorRunner&) = delete;
  DetectorRunner& operator=(const DetectorRunner&) = delete;

  /// Gives the thread a frame to look at; not before the last one was joined.
  void start(const RgbdFrame& frame);
  Answer join();  ///< Waits for the answer to the frame that was started last.
  /// As join(), if there is an answer by now.
  std::optional<Answer> poll();

 private:
  void run() noexcept;
  Answer answer(const RgbdFrame& frame);
  Answer failed() const;

  std::unique_ptr<Detector> detector_;  // used by thread_ only
  Channel<RgbdFrame> frames_{1};
  Channel<Answer> answers_{1};
  FirstError failure_;  ///< of the thread itself
  std::jthread thread_;
};

/// Boxes for every frame from a detector that is slower than the camera: it looks at the newest
/// frame whenever it is free, and its boxes are carried on to the frames that come meanwhile. Only
/// the first frame waits for it: a map must not begin with people in it.
///
/// With `latency_frames` an answer is used just so many frames after its frame, however long it
/// took: two runs see the same boxes. Thread: one.
class AsynchronousDetection {
 public:
  /// Starts its thread; boxes are carried on by the catalogue's classes.
  AsynchronousDetection(std::unique_ptr<Detector> detector, const DetectOptions& options,
                        const ObjectCatalogue& catalogue = ObjectCatalogue::defaults());

  /// Boxes for a frame.
  struct Boxes {
    /// Carried on to the frame; a failure of the detector is that of the frame.
    Result<Detections> detections = Detections{};
    StageTimes times;  ///< of what the caller did, and "detect" for an answer that came
  };
  /// The boxes of `frame`. Fails when the detector could not judge the frame that it looked at.
  Boxes next(const RgbdFrame& frame);
  /// Forgets all boxes; the next frame waits for its own, as the first one did.
  void forget();

 private:
  std::optional<DetectorRunner::Answer> answer_for(std::int64_t frame);

  DetectOptions options_;
  ObjectCatalogue catalogue_;
  DetectorRunner runner_;
  BoxCarrier carrier_;
  std::int64_t asked_ = -1;  // frame that the detector looks at, negative: none
  bool first_ = true;
};

}  // namespace ydd
