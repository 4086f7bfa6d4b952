# SPDX-License-Identifier: Apache-2.0
"""Photographs with boxes from public layouts, as frames: python3 -m detector.photographs OUT --boxes DIR ...

OUT/train/SET and OUT/judge/SET get NAME.jpg (longer side at most LONGEST), NAME.json ({"boxes": [[class,
x0, y0, x1, y1]], "ignore": [...]}) and labels.json ({"labelled": [...]}: the classes whose boxes the set
gives; all other classes are unknown there). A picture that kept_apart.txt names never comes in, from
whatever set it is; a tenth of the given sets goes to judge/, chosen by the name and the seed."""
from __future__ import annotations

import argparse
import dataclasses
import hashlib
import itertools
import json
import pathlib
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator

import cv2

from .data import LONGEST
from .files import write_whole
from .networks import COCO

Row = tuple[str, float, float, float, float]

COCO_CLASSES = ("person", "chair", "monitor", "keyboard", "mouse", "cup", "bottle", "book", "laptop", "phone", "bag")
VOC_CLASSES = ("person", "chair", "monitor", "bottle")
GIVEN = {
    "coco2017": COCO_CLASSES,
    "voc2007": VOC_CLASSES,
    "voc2007_layout": (*VOC_CLASSES, "head", "hand"),
    "hand_gesture": ("hand",),
    "hands_closeup": ("hand",),
    "map_indoor": ("chair", "book", "cup", "monitor", "bag", "bottle", "person"),
}
VOC_NAMES = {"person": "person", "chair": "chair", "tvmonitor": "monitor", "bottle": "bottle"}


@dataclasses.dataclass
class Photograph:
    set_: str
    name: str  # coco_000000000139, voc07_000005: the picture, whichever set it came with
    file: pathlib.Path
    boxes: list[Row]  # pixels of the file
    ignore: list[Row]
    labelled: tuple[str, ...]


def kept_apart(file: pathlib.Path) -> set[str]:
    """Names without their set: the same picture must not come in from elsewhere."""
    return {line.strip().rsplit("/", 1)[-1] for line in file.read_text().splitlines() if line.strip()}


def judged(name: str, seed: int, share: float) -> bool:
    digest = hashlib.sha256(f"{seed} {name}".encode()).digest()
    return int.from_bytes(digest[:4], "big") < share * 2**32


def region(row: list) -> Row:
    """An unknown region, with or without its class in front."""
    return (str(row[0]) if len(row) == 5 else "person", *(float(v) for v in row[-4:]))  # type: ignore[return-value]


# ---- the layouts
def given(folder: pathlib.Path) -> Iterator[Photograph]:
    """SET/NAME.jpg + NAME.json, the layout that this module writes."""
    for set_, labelled in GIVEN.items():
        for f in sorted((folder / set_).glob("*.json")):
            t = json.loads(f.read_text())
            boxes = [(b[0], *(float(v) for v in b[1:])) for b in t["boxes"]]
            yield Photograph(set_, f.stem, f.with_suffix(".jpg"), boxes, [region(b) for b in t["ignore"]], labelled)


def coco(pictures: pathlib.Path, lists: pathlib.Path) -> Iterator[Photograph]:
    """COCO pictures NUMBER.jpg anywhere below a folder; a text line `PATH x0,y0,x1,y1,class ...` for each."""
    rows = {}
    for line in lists.read_text().splitlines():
        path, *boxes = line.split()
        rows[pathlib.PurePath(path).stem] = [[int(v) for v in b.split(",")] for b in boxes]
    for f in sorted(pictures.rglob("*.jpg")):
        if f.stem in rows:
            boxes = [(COCO[b[4]], *(float(v) for v in b[:4])) for b in rows[f.stem] if b[4] in COCO]
            yield Photograph("coco2017_more", f"coco_{f.stem}", f, boxes, [], COCO_CLASSES)


def _corners(box: ElementTree.Element) -> tuple[float, ...]:
    x0, y0, x1, y1 = (float(box.findtext(k, "nan")) for k in ("xmin", "ymin", "xmax", "ymax"))
    return x0 - 1, y0 - 1, x1, y1  # VOC counts pixels from one


def voc_rows(annotation: pathlib.Path) -> tuple[list[Row], list[Row], bool]:
    """Boxes, unknown regions ("difficult" ones), and whether every person comes with its parts."""
    boxes, ignore, parts = [], [], True
    for o in ElementTree.parse(annotation).iterfind("object"):
        name, box = VOC_NAMES.get(o.findtext("name", "")), o.find("bndbox")
        if name is None or box is None:
            continue
        row = (name, *_corners(box))
        (ignore if o.findtext("difficult") == "1" else boxes).append(row)
        if name != "person":
            continue
        parts = parts and o.find("part") is not None
        for p in o.iterfind("part"):
            part, inner = p.findtext("name", ""), p.find("bndbox")
            if part in ("head", "hand") and inner is not None:
                boxes.append((part, *_corners(inner)))
    return boxes, ignore, parts and any(b[0] == "person" for b in boxes)  # type: ignore[return-value]


def voc(pictures: pathlib.Path, annotations: pathlib.Path) -> Iterator[Photograph]:
    """VOC 2007 pictures whose names begin with the number, with the original annotations.

    Where all persons have their heads and hands labelled, those are labelled classes too."""
    seen = set()
    for f in sorted(pictures.rglob("*.jpg")):
        number = f.stem[:6]
        xml = annotations / f"{number}.xml"
        if number in seen or not xml.exists():
            continue
        seen.add(number)
        boxes, ignore, whole = voc_rows(xml)
        set_, labelled = ("voc2007_more_layout", (*VOC_CLASSES, "head", "hand")) if whole else ("voc2007_more", VOC_CLASSES)
        if not whole:
            boxes = [b for b in boxes if b[0] not in ("head", "hand")]
        if not any(b[0] == "person" for b in boxes + ignore):  # then there are no heads or hands either
            set_, labelled = "voc2007_nobody", (*VOC_CLASSES, "head", "hand")
        yield Photograph(set_, f"voc07_{number}", f, boxes, ignore, labelled)


# ---- writing
def write(p: Photograph, folder: pathlib.Path) -> bool:
    image = cv2.imread(str(p.file))
    if image is None:
        return False
    k = min(1.0, LONGEST / max(image.shape[:2]))
    if k < 1:
        image = cv2.resize(image, None, fx=k, fy=k, interpolation=cv2.INTER_AREA)
    scaled = lambda rows: [[r[0], *(round(v * k, 1) for v in r[1:])] for r in rows]
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / "labels.json", json.dumps({"labelled": p.labelled}))
    cv2.imwrite(str(folder / f"{p.name}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, 93])
    write_whole(folder / f"{p.name}.json", json.dumps({"boxes": scaled(p.boxes), "ignore": scaled(p.ignore)}))
    return True


def choose(pictures: Iterator[Photograph], apart: set[str], seed: int, share: float) -> Iterator[tuple[str, Photograph]]:
    """train or judge for every picture that may be used, each name once: the first set that has it wins.

    Only pictures of the given sets are judged; the others are for training."""
    seen = set(apart)
    for p in pictures:
        if p.name in seen:
            continue
        seen.add(p.name)
        yield ("judge" if p.set_ in GIVEN and judged(p.name, seed, share) else "train"), p


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a = ap.add_argument
    a("out", type=pathlib.Path)
    a("--boxes", type=pathlib.Path, required=True, help="folder with the given sets and kept_apart.txt")
    a("--coco", type=pathlib.Path, nargs=2, metavar=("PICTURES", "LIST"))
    a("--voc", type=pathlib.Path, nargs=2, metavar=("PICTURES", "ANNOTATIONS"))
    a("--seed", type=int, default=14)
    a("--judge", type=float, default=0.1, help="share of the given pictures that is kept for judging")
    a("--every", type=int, default=1, help="only every Nth picture of what is given: for trying things out")
    args = ap.parse_args()

    def everything() -> Iterator[Photograph]:
        yield from given(args.boxes)
        if args.coco:
            yield from coco(*args.coco)
        if args.voc:
            yield from voc(*args.voc)

    count: dict[str, int] = {}
    apart = kept_apart(args.boxes / "kept_apart.txt")
    for part, p in itertools.islice(choose(everything(), apart, args.seed, args.judge), 0, None, args.every):
        if (args.out / part / p.set_ / f"{p.name}.json").exists() or write(p, args.out / part / p.set_):
            count[f"{part}/{p.set_}"] = count.get(f"{part}/{p.set_}", 0) + 1
    for k, n in sorted(count.items()):
        print(f"{k}: {n}")


if __name__ == "__main__":
    main()
