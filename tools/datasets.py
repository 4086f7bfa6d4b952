# SPDX-License-Identifier: Apache-2.0
"""Public RGB-D data sets for tools/get-datasets: addresses as their publishers give them.

Sizes are those that the publishers' servers tell (bytes); None: not looked up, the server's word counts.
"""
import collections

# folder: what the archive unpacks to; None: it has no folder of its own, its name is taken.
Dataset = collections.namedtuple("Dataset", "name groups publisher url size folder")
Publisher = collections.namedtuple("Publisher", "page licence")

PUBLISHERS = {
    "tum": Publisher(
        "https://cvg.cit.tum.de/data/datasets/rgbd-dataset",
        "TUM RGB-D benchmark: CC BY 4.0; cite J. Sturm et al., A Benchmark for the Evaluation of RGB-D SLAM "
        "Systems, IROS 2012",
    ),
    "bonn": Publisher(
        "https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset",
        "Bonn RGB-D Dynamic: no licence is named; for research; cite E. Palazzolo et al., ReFusion, IROS 2019",
    ),
    "icl": Publisher(
        "https://www.doc.ic.ac.uk/~ahanda/VaFRIC/iclnuim.html",
        "ICL-NUIM: CC BY 3.0; cite A. Handa et al., A Benchmark for RGB-D Visual Odometry, 3D Reconstruction and "
        "SLAM, ICRA 2014",
    ),
}

# Not to be had without a person who agrees to something first.
BY_HAND = {
    "openloris": "OpenLORIS-Scene is given after a form on https://lifelong-robotic-vision.github.io/dataset/scene "
    "(CC BY-ND 4.0): download it there; ydd-slam run takes its folders"
}

_TUM = {
    1: "360 desk desk2 floor plant room rpy teddy xyz",
    2: "360_hemisphere 360_kidnap coke desk desk_with_person dishes flowerbouquet flowerbouquet_brownbackground "
    "large_no_loop large_with_loop metallic_sphere metallic_sphere2 pioneer_360 pioneer_slam pioneer_slam2 "
    "pioneer_slam3 rpy xyz",
    3: "cabinet large_cabinet long_office_household nostructure_notexture_far nostructure_notexture_near_withloop "
    "nostructure_texture_far nostructure_texture_near_withloop structure_notexture_far structure_notexture_near "
    "structure_texture_far structure_texture_near teddy sitting_halfsphere sitting_rpy sitting_static sitting_xyz "
    "walking_halfsphere walking_rpy walking_static walking_xyz",
}
_BONN = (
    "balloon balloon2 balloon_tracking balloon_tracking2 crowd crowd2 crowd3 kidnapping_box kidnapping_box2 "
    "moving_nonobstructing_box moving_nonobstructing_box2 moving_obstructing_box moving_obstructing_box2 "
    "person_tracking person_tracking2 placing_nonobstructing_box placing_nonobstructing_box2 "
    "placing_nonobstructing_box3 placing_obstructing_box removing_nonobstructing_box removing_nonobstructing_box2 "
    "removing_obstructing_box static static_close_far synchronous synchronous2"
)
_SIZES = {
    "fr1_xyz": 448204271,
    "fr1_desk": 344011403,
    "fr2_desk": 1893351095,
    "fr3_walking_static": 474074105,
    "fr3_walking_xyz": 527550055,
    "bonn_balloon": 243818512,
    "icl_living_room_0": 711444709,
}
_ARTICLE = ("fr3_walking_xyz", "fr3_walking_rpy", "fr3_walking_halfsphere", "fr3_walking_static", "fr3_sitting_static")


def all_datasets():
    """Every data set by name."""
    out = []
    for number, sequences in _TUM.items():
        for sequence in sequences.split():
            name = f"fr{number}_{sequence}"
            folder = f"rgbd_dataset_freiburg{number}_{sequence}"
            groups = [f"tum_fr{number}"]
            if number == 3 and sequence.startswith(("walking", "sitting")):
                groups.append(f"tum_fr3_{sequence.split('_')[0]}")
            if name in _ARTICLE:
                groups.append("article")
            url = f"https://cvg.cit.tum.de/rgbd/dataset/freiburg{number}/{folder}.tgz"
            out.append(Dataset(name, groups, "tum", url, _SIZES.get(name), folder))
    for sequence in _BONN.split():
        folder = f"rgbd_bonn_{sequence}"
        url = f"https://www.ipb.uni-bonn.de/html/projects/rgbd_dynamic2019/{folder}.zip"
        out.append(Dataset(f"bonn_{sequence}", ["bonn"], "bonn", url, _SIZES.get(f"bonn_{sequence}"), folder))
    for room, prefix in (("living_room", "living_room_traj"), ("office", "traj")):
        for number in range(4):
            name = f"icl_{room}_{number}"
            url = f"https://www.doc.ic.ac.uk/~ahanda/{prefix}{number}_frei_png.tar.gz"
            out.append(Dataset(name, ["icl"], "icl", url, _SIZES.get(name), None))
    return {d.name: d for d in out}
