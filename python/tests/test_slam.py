# SPDX-License-Identifier: Apache-2.0
"""Slam and what it gives."""
import gc
import subprocess
import sys
import threading
import time
import weakref
from pathlib import Path

import numpy as np
import pytest

import ydd_slam
from ydd_slam import Detection, Error, RgbdFrame, Slam

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "office_crowd"
OFF = {"deterministic": True, "dynamics.variant": "off"}
FULL = {"deterministic": True, "dynamics.variant": "full"}


def test_frames_tell_pose_state_points_and_rules(run, sample):
    slam, frames = run
    assert [f.state for f in frames] == ["tracking"] * len(sample)
    assert [f.index for f in frames] == list(range(len(sample)))
    frame = frames[-1]
    assert frame.stamp_ns == sample.stamps_ns[len(sample) - 1]
    assert frame.T_world_camera.shape == (4, 4) and frame.covariance.shape == (6, 6)
    n = len(frame.kept)
    assert frame.kept.pixels.shape == frame.kept.undistorted_px.shape == (n, 2)
    assert frame.kept.descriptors.shape == (n, 32) and frame.kept.depth_m.shape == (n,)
    assert (frame.kept.map_points >= 0).sum() >= frame.inliers > 50
    rejected = frame.rejected
    assert len(rejected) > 20 and rejected.pixels.shape == (len(rejected), 2)
    assert rejected.rules == [ydd_slam.RULES[code] for code in rejected.rule]
    assert "body_depth" in rejected.rules and "kept" not in rejected.rules
    people = [o for o in frame.objects if o.kind == "person"]
    assert people and all(o.class_name == "person" for o in people)
    assert frame.tracks and all(t.position_m.shape == (3,) for t in frame.tracks)
    assert frame.times_ms["total"] > 0
    assert frames[0].keyframe and len(slam.trajectory()) == len(frames)


def test_a_recording_without_any_lag_of_mapping_is_mapped_as_on_one_thread(sample):
    maps = []
    for options in (OFF, {"mapping_lag_s": 0, "dynamics.variant": "off"}):
        with Slam(sample.camera, options, detector=None) as slam:
            for i in range(len(sample)):
                slam.process(sample[i])
            slam.finish()
            maps.append(slam.map.points)
    np.testing.assert_array_equal(maps[0], maps[1])


def test_arrays_are_read_only_views_that_outlive_their_frame(run):
    kept = run[1][3].kept
    pixels, again = kept.pixels, kept.pixels
    assert np.shares_memory(pixels, again)
    with pytest.raises(ValueError):
        pixels[0, 0] = 1


def test_a_view_keeps_its_frame_alive(sample):
    slam = Slam(sample.camera, OFF, detector=None)
    pixels = slam.process(sample[0]).kept.pixels
    copy = pixels.copy()
    del slam
    gc.collect()
    assert (pixels == copy).all() and len(copy) > 100


def test_arrays_and_frames_give_the_same(sample):
    texts = []
    for as_arrays in (True, False):
        slam = Slam(sample.camera, OFF, detector=None)
        for picture in sample:
            if as_arrays:
                slam.process(picture.colour.copy(), picture.depth_m, stamp_ns=picture.stamp_ns)
            else:
                slam.process(picture)
        texts.append(slam.trajectory().text())
    assert texts[0] == texts[1] and texts[0].count("\n") == len(sample)


def test_depth_in_counts_and_in_metres_is_the_same(sample):
    camera, picture = sample.camera, sample[0]
    counts = np.round(picture.depth_m * camera.depth_scale).astype(np.uint16)
    again = RgbdFrame(picture.colour, counts, camera, stamp=1.5)
    assert np.allclose(again.depth_m, picture.depth_m, atol=1e-4)
    assert again.stamp_ns == 1_500_000_000
    assert (RgbdFrame(picture.colour, counts.astype(np.int32), camera, stamp=1.5).depth_m == again.depth_m).all()
    doubles = picture.depth_m.astype(np.float64)
    doubles[0, 0] = np.nan
    assert RgbdFrame(picture.colour, doubles, camera, stamp=1.5).depth_m[0, 0] == 0


class Tensor:
    """What gives itself as an array, as those of other libraries do."""

    def __init__(self, array):
        self.array = array

    def __array__(self, *_):
        return self.array


def test_tensors_are_arrays(sample):
    picture, mask = sample[0], np.zeros((2, 480, 640), bool)
    mask[0, 100:380, 200:450] = mask[1, :50, :50] = True
    frames = [
        Slam(sample.camera, FULL, detector=None).process(colour, depth, 1.0, masks=masks)
        for colour, depth, masks in (
            (picture.colour, picture.depth_m, mask),
            (Tensor(picture.colour), Tensor(picture.depth_m), Tensor(mask)),
            (picture.colour, picture.depth_m, [("person", Tensor(mask[0])), ("person", Tensor(mask[1]))]),
        )
    ]
    assert [[d.box for d in f.detections] for f in frames] == [[(200, 100, 450, 380), (0, 0, 50, 50)]] * 3
    assert len({len(f.rejected) for f in frames}) == 1 and len(frames[0].rejected) > 50


def test_what_nobody_may_write_is_shared_the_rest_is_copied(sample):
    colour = np.zeros((480, 640, 3), np.uint8)
    depth = np.ones((480, 640), np.float32)
    copied = RgbdFrame(colour, depth, sample.camera, stamp=0)
    assert not np.shares_memory(copied.colour, colour)
    colour.flags.writeable = False
    shared = RgbdFrame(colour, depth, sample.camera, stamp=0)
    assert np.shares_memory(shared.colour, colour)
    assert not shared.colour.flags.writeable
    assert not np.shares_memory(shared.depth_m, depth)
    depth[0, 0] = 0
    depth.flags.writeable = False
    assert np.shares_memory(RgbdFrame(colour, depth, sample.camera, stamp=0).depth_m, depth)
    far = np.full_like(depth, 1000)  # must become "no reading"
    far.flags.writeable = False
    assert not RgbdFrame(colour, far, sample.camera, stamp=0).depth_m.any() and far.all()


def test_a_shared_picture_is_let_go_with_its_last_user(sample):
    colour = np.zeros((480, 640, 3), np.uint8)
    colour.flags.writeable = False
    gone = []
    weakref.finalize(colour, gone.append, True)
    slam = Slam(sample.camera, OFF, detector=None)
    frame = RgbdFrame(colour, np.ones((480, 640), np.float32), sample.camera, stamp=0)
    slam.process(frame)
    pixels = frame.colour
    del colour, frame, slam
    gc.collect()
    assert not gone and not pixels.any()
    del pixels
    gc.collect()
    assert gone


def test_a_detector_of_ones_own(sample, boxes, run):
    seen = []

    def look(frame):
        seen.append((frame.index, frame.colour.shape, threading.current_thread() is threading.main_thread()))
        return [(d.class_name, d.box, d.score) for d in boxes(frame)]

    slam = Slam(sample.camera, FULL, detector=look)
    frames = [slam.process(picture) for picture in sample]
    slam.finish()
    assert [index for index, _, _ in seen] == list(range(len(sample)))
    assert all(shape == (480, 640, 3) for _, shape, _ in seen)
    assert slam.trajectory().text() == run[0].trajectory().text()
    assert [len(f.rejected) for f in frames] == [len(f.rejected) for f in run[1]]


def test_detections_with_the_picture_stand_for_the_detectors(sample, boxes, run):
    slam = Slam(sample.camera, FULL, detector=None)
    for picture in sample:
        slam.process(picture, detections=boxes(picture))
    slam.finish()
    assert slam.trajectory().text() == run[0].trajectory().text()


def test_who_is_not_surely_there_costs_points_but_is_not_told_of(sample, boxes, run):
    def doubted(picture):
        return [Detection(d.class_name, d.box, d.score, sure=False) for d in boxes(picture)]

    slam = Slam(sample.camera, FULL, detector=None)
    frames = [slam.process(picture, detections=doubted(picture)) for picture in sample]
    assert any(f.tracks for f in run[1]) and not any(f.tracks for f in frames)
    assert [len(f.rejected) for f in frames] == [len(f.rejected) for f in run[1]]


def test_a_mask_says_which_points_are_on_a_person(sample):
    slam = Slam(sample.camera, FULL, detector=None)
    mask = np.zeros((480, 640), bool)
    mask[100:380, 200:450] = True
    frame = slam.process(sample[0], masks=mask)
    x, y = np.round(frame.kept.pixels).astype(int).T
    assert len(x) > 50 and not mask[y, x].any()
    x, y = np.round(frame.rejected.pixels).astype(int).T
    grown = np.zeros_like(mask)
    grown[96:384, 196:454] = True  # points at the edge go too
    assert len(x) > 50 and grown[y, x].all() and not grown.all()
    assert frame.objects[0].moves
    # A thing that nobody moves stays; an unknown class never moves.
    for name in ("chair", "wallpaper"):
        frame = Slam(sample.camera, FULL, detector=None).process(sample[0], masks=[(name, mask)])
        assert len(frame.rejected) == 0, name


def test_a_failing_detector_is_the_cause_of_the_error(sample):
    def look(frame):
        if frame.index == 1:
            raise KeyError("no weights\nfor this")
        return []

    slam = Slam(sample.camera, FULL, detector=look)
    slam.process(sample[0])
    with pytest.raises(Error) as raised:
        slam.process(sample[1])
    assert str(raised.value) == r"detector: KeyError: 'no weights\nfor this'"
    assert isinstance(raised.value.__cause__, KeyError)
    assert slam.process(sample[2]).state == "tracking"


@pytest.mark.parametrize(
    "answer, line",
    [
        (None, "detector: must be a list of Detection or of (class, box, score)"),
        ([("person", 3)], "detector: item 0 is no Detection nor (class, (x0, y0, x1, y1), score)"),
        ([("person", (0.1, 0.1, 0.5, 0.9))], "detector: all boxes lie between 0 and 1"),
        ([("person", (0, 0, 5, 9), 3.0)], "detector: detection 0 ('person') has the score 3"),
    ],
)
def test_what_a_detector_may_not_answer(sample, answer, line):
    with pytest.raises(Error) as raised:
        Slam(sample.camera, FULL, detector=lambda frame: answer).process(sample[0])
    assert str(raised.value).startswith(line) and "\n" not in str(raised.value)


def test_wrong_arguments_are_one_line_each(sample):
    picture, camera = sample[0], sample.camera
    slam = Slam(camera, OFF, detector=None)
    small = np.zeros((10, 20), np.uint8)
    for wrong, line in [
        (lambda: Slam(camera, {"dynamics.varian": 1}), "dynamics.varian"),
        (lambda: Slam(camera, {"orb.levels": 99}), "orb.levels"),
        (lambda: Slam(camera, detector="missing.yaml"), "missing.yaml"),
        (lambda: Slam(camera, config="missing.yaml"), "missing.yaml"),
        (lambda: Slam(camera, map="missing.ydd", detector=None), "missing.ydd"),
        (lambda: slam.process(picture.colour, picture.depth_m), "give either stamp"),
        (lambda: slam.process(picture.colour, picture.depth_m, 1e18), "nanoseconds are stamp_ns"),
        (lambda: slam.process(picture.colour.astype(float), picture.depth_m, 1), "colour: must have the shape"),
        (lambda: slam.process([[1, 2], [3, 4]], picture.depth_m, 1), "colour: must be an array, not list"),
        (lambda: slam.process(picture.colour, small.astype(np.int64) - 1, 1), "depth: counts must be in [0, 65535]"),
        (lambda: slam.process(picture.colour, small > 0, 1), "depth: must have the shape"),
        (lambda: slam.process(small, picture.depth_m, 1), "the camera 640 x 480"),
        (lambda: slam.process(picture, masks=small), "a mask of 20 x 10"),
        (lambda: slam.process(picture, masks=[small]), "masks: item 0"),
        (lambda: slam.process(picture, detections=3), "detections: must be a list"),
        (lambda: Detection("person"), "give a box or a mask"),
        (lambda: ydd_slam.Camera(fx_px=-1), "fx"),
        (lambda: ydd_slam.Camera(focal=1), "no 'focal'"),
    ]:
        with pytest.raises(Error) as raised:
            wrong()
        assert line in str(raised.value) and "\n" not in str(raised.value)
    assert slam.process(picture).state == "tracking"  # none of them harmed it
    with pytest.raises(Error, match="reset to start anew"):
        slam.process(picture)


def test_finish_reset_and_with(sample):
    with Slam(sample.camera, OFF, detector=None) as slam:
        slam.process(sample[0])
    with pytest.raises(Error, match="has finished"):
        slam.process(sample[1])
    slam.reset()
    assert slam.process(sample[2]).keyframe and len(slam.trajectory()) == 1


def gets_on_meanwhile(work):
    """Whether another thread gets on while `work`, perhaps tried several times, is under way."""
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0)  # lets go of the GIL, and asks for it again

    counter, interval = threading.Thread(target=count), sys.getswitchinterval()
    sys.setswitchinterval(1000)  # whoever has the GIL keeps it until they let go
    counter.start()
    try:
        before = counted[0]
        for _ in range(100):
            work()
            if counted[0] > before:
                return True
        return False
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        counter.join()


def test_what_takes_time_lets_other_threads_run(run, sample, tmp_path):
    assert not gets_on_meanwhile(lambda: sum(range(1000)))
    the_map, slam = run[0].map, Slam(sample.camera, OFF, detector=None)
    pictures = iter(sample)
    world = ydd_slam.simulate({"frames": 1, "width": 160, "height": 120})
    for work in (
        lambda: slam.process(next(pictures)),
        lambda: sample[0],
        lambda: world[0],
        lambda: the_map.dense_cloud(0.1),
        lambda: the_map.localise(sample[0]),
        lambda: the_map.save(tmp_path / "map.ydd"),
        lambda: ydd_slam.Map.load(tmp_path / "map.ydd"),
        lambda: Slam(sample.camera, OFF, detector=None, map=the_map),
    ):
        assert gets_on_meanwhile(work)


def test_other_threads_run_meanwhile_and_a_second_caller_is_told(sample):
    counted = [0]
    stop = threading.Event()
    entered = threading.Event()
    let_go = threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1

    def look(frame):
        entered.set()
        let_go.wait(60)
        return []

    slam = Slam(sample.camera, FULL, detector=look)
    worker = threading.Thread(target=slam.process, args=(sample[0],))
    counter = threading.Thread(target=count)
    worker.start()
    assert entered.wait(60)
    counter.start()
    with pytest.raises(Error, match="one call at a time"):
        slam.process(sample[1])
    let_go.set()
    worker.join()
    stop.set()
    counter.join()
    assert counted[0] > 0 and len(slam.trajectory()) == 1


def test_motion_sensors_are_taken(sample):
    slam = Slam(sample.camera, OFF, detector=None)
    slam.add_imu(int(sample.stamps_ns[0]) - 1, np.zeros(3), np.array([0, -9.81, 0]))
    slam.add_odometry(int(sample.stamps_ns[0]) - 1, np.eye(4))
    with pytest.raises(Error, match="T_odom_base: must be a rigid motion"):
        slam.add_odometry(int(sample.stamps_ns[0]), np.full((4, 4), 2.0))
    assert slam.process(sample[0]).state == "tracking"


@pytest.mark.parametrize("mode", ["every-frame", "asynchronous"])
def test_python_may_end_while_a_detector_looks(mode):
    code = f"""
import time, ydd_slam
sequence = ydd_slam.open_sequence({str(SAMPLE)!r}, max_frames=4)
def look(frame):
    time.sleep(0.2)
    return []
slam = ydd_slam.Slam(sequence.camera, {{"detect.mode": {mode!r}}}, detector=look)
print(*[slam.process(picture).state for picture in sequence])
look.never_collected = slam
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["tracking"] * 4 and told.stderr == ""
