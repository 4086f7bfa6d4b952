# SPDX-License-Identifier: Apache-2.0
"""Maps as arrays, clouds and files."""
import gc

import numpy as np
import pytest

import ydd_slam
from ydd_slam import Error, Map, Slam


def test_arrays_fit_together(run):
    slam, frames = run
    the_map = slam.map
    points, keyframes = the_map.points, the_map.keyframe_poses
    assert points.shape == the_map.normals.shape == (len(points), 3) and len(points) > 200
    assert the_map.descriptors.shape == (len(points), 32)
    assert keyframes.shape == (len(the_map.keyframe_frames), 4, 4) and len(keyframes) >= 2
    assert np.allclose(keyframes[0], np.eye(4))
    assert set(the_map.keyframe_frames) == {f.index for f in frames if f.keyframe}
    seen = the_map.observations
    assert seen.shape[1] == 3 and seen[:, 0].max() < len(keyframes) and seen[:, 1].max() == len(points) - 1
    # Each landmark lies in front of the keyframes that see it.
    R, t = keyframes[:, :3, :3], keyframes[:, :3, 3]
    local = np.einsum("nji,nj->ni", R[seen[:, 0]], points[seen[:, 1]] - t[seen[:, 0]])
    assert (local[:, 2] > 0).all()
    for a, b, weight in the_map.covisibility:
        assert a < b
        both = set(seen[seen[:, 0] == a, 1]) & set(seen[seen[:, 0] == b, 1])
        assert len(both) == pytest.approx(weight, rel=0.1)  # counted when they were last looked at
    assert np.isin(frames[-1].kept.map_points, the_map.point_ids).sum() > 50


def test_a_map_is_as_it_was_when_it_was_asked_for(sample):
    slam = Slam(sample.camera, {"deterministic": True, "dynamics.variant": "off"}, detector=None)
    assert len(slam.map.points) == 0 and slam.map.maps == []
    slam.process(sample[0])
    first = slam.map
    before = len(first.points)
    for picture in list(sample)[1:]:
        slam.process(picture)
    assert len(first.points) == before < len(slam.map.points)


def test_saved_loaded_and_localised_in(run, sample, tmp_path):
    slam = run[0]
    file = tmp_path / "office.ydd"
    slam.save(str(file))
    loaded = Map.load(str(file))
    assert (loaded.points == slam.map.points).all() and loaded.camera.fx_px == sample.camera.fx_px
    T = loaded.localise(sample[5])
    true = run[1][5].T_world_camera
    assert np.linalg.norm(T[:3, 3] - true[:3, 3]) < 0.03
    black = ydd_slam.RgbdFrame(
        np.zeros((480, 640, 3), np.uint8), np.ones((480, 640), np.float32), sample.camera, stamp=0
    )
    assert loaded.localise(black) is None
    with Slam(sample.camera, {"deterministic": True}, detector=None, map=str(file), localization_only=True) as again:
        frame = again.process(sample[3])
    assert frame.state == "tracking" and not frame.keyframe
    assert len(again.map.points) == len(loaded.points)
    with pytest.raises(Error, match="office.ydd"):
        Slam(ydd_slam.Camera(), detector=None, map=str(file))
    loaded.save(str(tmp_path / "copy.ydd"))
    assert (Map.load(str(tmp_path / "copy.ydd")).points == loaded.points).all()


def test_a_map_at_hand_is_gone_on_with_as_one_of_a_file(run, sample, tmp_path):
    the_map, file = run[0].map, tmp_path / "office.ydd"
    before = the_map.points
    the_map.save(file)
    texts = []
    for given in (the_map, file):
        with Slam(sample.camera, {"deterministic": True}, detector=None, map=given) as slam:
            frames = [slam.process(sample[i]) for i in (3, 7, 11)]
        assert frames[0].state == "tracking" and set(the_map.point_ids) & set(frames[0].kept.map_points)
        texts.append(slam.trajectory().text() + str(slam.map.points.tolist()))
    assert texts[0] == texts[1]
    assert (the_map.points == before).all()  # it stays as it was
    slam.load(the_map)
    assert (slam.map.maps[0].points == before).all() and slam.process(sample[5]).state == "tracking"
    with pytest.raises(Error, match="^map: "):
        Slam(ydd_slam.Camera(), detector=None, map=the_map)
    with Slam(
        sample.camera, {"deterministic": True}, detector=None, map=Slam(sample.camera, detector=None).map
    ) as slam:
        assert slam.process(sample[0]).keyframe  # from an empty one it starts anew


def test_observations_name_what_keyframes_saw(run):
    the_map = run[0].map
    seen, points, poses, K = the_map.observations, the_map.points, the_map.keyframe_poses, the_map.camera.K
    for index in range(len(poses)):
        features = the_map.keyframe_features(index)
        of_it = seen[seen[:, 0] == index]
        assert (features.map_points[of_it[:, 2]] == the_map.point_ids[of_it[:, 1]]).all()
        local = (points[of_it[:, 1]] - poses[index, :3, 3]) @ poses[index, :3, :3]
        pixels = (local @ K.T)[:, :2] / local[:, 2:]
        errors_px = np.linalg.norm(pixels - features.undistorted_px[of_it[:, 2]], axis=1)
        assert len(errors_px) > 50 and np.median(errors_px) < 2
    with pytest.raises(IndexError):
        the_map.keyframe_features(len(poses))
    descriptors = features.descriptors
    del features, the_map
    gc.collect()
    assert descriptors.any() and not descriptors.flags.writeable


def test_clouds_and_grid(run, tmp_path):
    the_map = run[0].map
    points, colours = the_map.dense_cloud(voxel_m=0.05)
    assert len(points) > 1000 and points.shape == colours.shape == (len(points), 3)
    assert np.isfinite(points).all() and colours.dtype == np.uint8 and not points.flags.writeable
    the_map.write_ply(str(tmp_path / "dense.ply"), voxel_m=0.05)
    head, body = (tmp_path / "dense.ply").read_bytes().split(b"end_header\n", 1)
    assert f"element vertex {len(points)}".encode() in head
    assert (np.frombuffer(body, "<f4", 3) == points[0]).all()
    the_map.write_ply(str(tmp_path / "sparse.ply"), dense=False)
    assert b"element vertex" in (tmp_path / "sparse.ply").read_bytes()[:200]
    grid = the_map.occupancy_grid(0.1)
    assert grid["cells"].ndim == 2 and set(np.unique(grid["cells"])) <= {-1, 0, 100}
    colour, depth_mm = the_map.keyframe_picture(0)
    assert colour.shape == (240, 320, 3) and depth_mm.shape == (240, 320) and depth_mm.any()
    with pytest.raises(IndexError):
        the_map.keyframe_picture(10_000)
    with pytest.raises(Error, match="voxel_m"):
        the_map.dense_cloud(voxel_m=0)


def test_a_file_that_is_no_map_is_one_line(tmp_path):
    file = tmp_path / "no.ydd"
    file.write_text("no map\n")
    with pytest.raises(Error) as raised:
        Map.load(str(file))
    assert str(file) in str(raised.value) and "\n" not in str(raised.value)


def test_files_may_have_a_key(run, tmp_path):
    key = tmp_path / "key"
    key.write_text("0123456789abcdef" * 4)
    key.chmod(0o600)
    file = tmp_path / "a.ydd"
    try:
        run[0].map.save(file, map_key=key)
    except Error as e:
        if "SQLCipher" in str(e):
            pytest.skip(str(e))
        raise
    assert b"SQLite format 3" not in file.read_bytes()
    assert len(Map.load(file, map_key=key.read_bytes()).points) == len(run[0].map.points)
    with pytest.raises(Error, match="--map-key"):
        Map.load(file)
    with pytest.raises(Error, match="does not open with this key") as wrong:
        Map.load(file, map_key=b"fedcba9876543210" * 4)
    assert "fedcba" not in str(wrong.value)
    key.chmod(0o604)
    with pytest.raises(Error, match="chmod 600"):
        Map.load(file, map_key=str(key))
