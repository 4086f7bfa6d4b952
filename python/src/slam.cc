// SPDX-License-Identifier: Apache-2.0
#include "slam.h"

#include <set>
#include <utility>

#include <pybind11/eigen.h>

#include "arrays.h"
#include "options.h"
#include "ydd/dataset/sequence.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/person_check.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/map_files/map_file.h"

namespace ydd::python {
namespace {

/// All that there are; under the GIL.
std::set<Slam*>& live() {
  static std::set<Slam*> all;
  return all;
}

using DetectorMaker = std::function<Result<std::unique_ptr<Detector>>()>;

std::string text_or_empty(const py::object& given) {
  return given.is_none() ? "" : py::str(given).cast<std::string>();
}

/// Defaults, then the file, then the dictionary. A file that a run has saved also tells camera and
/// sequence: these are the caller's here.
SystemOptions system_options_from(const py::object& options, const std::string& config) {
  SystemOptions out;
  OptionTable table;
  out.describe(table);
  Camera of_file;
  SequenceOptions sequence_of_file;
  OptionTable whole;
  out.describe(whole);
  whole.group("camera", of_file);
  whole.group("sequence", sequence_of_file);
  if (!config.empty()) value_of(whole.load_yaml(config));
  set_options(settings_from(options), table);
  value_of(check(out.reckoning));
  return out;
}

Result<std::unique_ptr<Detector>> recorded_detector(const std::string& file,
                                                    const ObjectCatalogue& catalogue) {
  Result<DetectionRecording> recording = DetectionRecording::read(file);
  if (!recording) return recording.error();
  return std::unique_ptr<Detector>(
      std::make_unique<RecordedDetector>(named_by_rules(*std::move(recording), catalogue), file));
}

/// Of a detector file, or of a recording.
DetectorMaker maker_of_file(const std::string& file, const ObjectCatalogue& catalogue) {
  const bool recorded = file.ends_with(".jsonl");
  return [=]() -> Result<std::unique_ptr<Detector>> {
    return recorded ? recorded_detector(file, catalogue) : make_detector(file, {}, catalogue);
  };
}

/// A map at hand, or the name of a file.
struct GivenMap {
  std::optional<Map> map;
  std::string file;
};

GivenMap map_from(const py::object& given) {
  if (py::isinstance<Map>(given)) return {given.cast<Map>(), ""};
  return {std::nullopt, text_or_empty(given)};
}

}  // namespace

Slam::Slam(const Wish& wish) {
  RobotSetup setup;
  setup.camera = wish.camera;
  setup.options = system_options_from(wish.options, text_or_empty(wish.config));
  setup.catalogue = wish.objects.is_none()
                        ? ObjectCatalogue::defaults()
                        : value_of(ObjectCatalogue::load(text_or_empty(wish.objects)));
  setup.T_map_world = SE3();
  setup.autosave_file = text_or_empty(wish.autosave);
  setup.map_key = map_key_from(wish.map_key);
  setup.patient = !wish.live;
  if (PyCallable_Check(wish.detector.ptr()) != 0) {
    look_ = make_look(py::reinterpret_borrow<py::function>(wish.detector));
    setup.make_detector = [look = look_, objects = setup.catalogue] {
      return Result(std::unique_ptr<Detector>(std::make_unique<CallableDetector>(look, objects)));
    };
  } else if (text_or_empty(wish.detector) != "default") {
    const std::string file = text_or_empty(wish.detector);
    if (!file.empty()) setup.make_detector = maker_of_file(file, setup.catalogue);
  } else if (setup.options.dynamics.variant != Variant::off) {
    const auto found = py::module_::import("ydd_slam._files").attr("default_detector")();
    setup.make_detector = maker_of_file(found.cast<std::string>(), setup.catalogue);
  }
  const GivenMap map = map_from(wish.map);
  slam_ = without_gil([&] {
    return std::make_unique<RobotSlam>(
        value_of(map.map ? RobotSlam::make(std::move(setup), atlas_of(*map.map), "map")
                         : RobotSlam::make(std::move(setup), map.file)));
  });
  slam_->set_localization_only(wish.localization_only);
  camera_ = slam_->setup().camera;
  live().insert(this);
}

Slam::~Slam() {
  live().erase(this);
  close();
}

void Slam::close() {
  const py::gil_scoped_release release;  // its detector may wait for the GIL
  slam_.reset();
}

void Slam::close_all() {
  for (Slam* const slam : std::set<Slam*>(live())) {
    if (!slam->busy_) slam->close();
  }
}

void Slam::fail(const Error& error) const {
  if (look_ && look_->raised) {
    // What the detector raised is the cause of the error.
    const py::object cause = std::exchange(look_->raised, py::object());
    const py::object type = py::module_::import("ydd_slam").attr("Error");
    const py::object raised = type(error.message);
    PyException_SetCause(raised.ptr(), py::object(cause).release().ptr());
    PyErr_SetObject(type.ptr(), raised.ptr());
    throw py::error_already_set();
  }
  throw Failure(error.message);
}

std::shared_ptr<RobotFrame> Slam::process(const RgbdFrame& frame, const py::object& detections,
                                          const py::object& masks) {
  if (finished_) throw Failure("this Slam has finished: reset() starts anew");
  if (frame.grey.width() != camera_.width_px || frame.grey.height() != camera_.height_px) {
    throw Failure("the frame is not of the camera's size");
  }
  std::optional<Detections> given;
  if (!detections.is_none()) given = detections_from(detections, "detections");
  if (!masks.is_none()) {
    if (!given) given.emplace();
    Detections masked = masks_from(masks);
    given->insert(given->end(), masked.begin(), masked.end());
  }
  Result<RobotFrame> pushed = once([&] { return slam_->push(frame, std::move(given)); });
  if (!pushed) fail(pushed.error());
  return std::make_shared<RobotFrame>(*std::move(pushed));
}

void Slam::add(const ImuSample& sample) {
  once([&] { slam_->add(sample); });
}

void Slam::add(const OdometryPose& pose) {
  once([&] { slam_->add(pose); });
}

void Slam::finish(bool prompt) {
  const Result<void> done =
      once([&] { return slam_->finish(prompt ? Ending::prompt : Ending::complete); });
  finished_ = true;
  if (!done) fail(done.error());
}

void Slam::reset() {
  once([&] { slam_->reset(); });
  finished_ = false;
}

void Slam::save(const std::filesystem::path& file) {
  value_of(once([&] { return slam_->save_map(file); }));
}

void Slam::load(const py::object& given) {
  const GivenMap map = map_from(given);
  value_of(once([&] {
    return map.map ? slam_->set_map(atlas_of(*map.map), "map") : slam_->load_map(map.file);
  }));
  finished_ = false;
}

bool Slam::localization_only() {
  return once([&] { return slam_->localization_only(); });
}

void Slam::set_localization_only(bool on) {
  once([&] { slam_->set_localization_only(on); });
}

Trajectory Slam::trajectory() {
  return once([&] { return Trajectory{slam_->system().trajectory()}; });
}

Trajectory Slam::keyframe_trajectory() {
  return once([&] { return Trajectory{slam_->system().keyframe_trajectory()}; });
}

int Slam::loops() {
  return once([&] { return slam_->loops(); });
}

Map Slam::map() {
  std::shared_ptr<const Atlas> atlas = once([&] { return slam_->system().atlas(); });
  const MapId now = slam_->newest_map()->map;
  return now.valid() ? Map{std::move(atlas), now} : largest_map(std::move(atlas));
}

}  // namespace ydd::python
