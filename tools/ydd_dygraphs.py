# SPDX-License-Identifier: Apache-2.0
"""Plots by dygraphs as one picture, for the documentation. Needs Chromium and Debian's libjs-dygraphs
(tools/install-deps); the page that the picture is taken of is thrown away."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

LIBRARY = pathlib.Path("/usr/share/javascript/dygraphs")
WIDTH_PX = 880


def draw(plots, picture, height_px):
    """`plots`: (rows, options) of each, one below the other, `height_px` high."""
    browser = shutil.which("chromium") or sys.exit("no Chromium here")
    script = (LIBRARY / "dygraph.min.js").read_text(encoding="utf-8")
    style = (LIBRARY / "dygraph.min.css").read_text(encoding="utf-8")
    common = {"legend": "always", "strokeWidth": 2, "width": WIDTH_PX, "height": height_px}
    body = "".join(
        f"<div id='p{i}'></div><script>new Dygraph(document.getElementById('p{i}'),"
        f"{json.dumps(rows)},{json.dumps({**common, **options})});</script>"
        for i, (rows, options) in enumerate(plots)
    )
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / "plots.html"
        page.write_text(
            f"<meta charset='utf-8'><style>{style} .dygraph-legend{{background:none}} body{{font-family:sans-serif}}"
            f"</style><script>{script}</script>{body}",
            encoding="utf-8",
        )
        size = f"--window-size={WIDTH_PX + 20},{len(plots) * height_px + 50}"
        subprocess.run(
            [browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
             "--disable-background-networking", "--hide-scrollbars", "--disable-component-update", "--disable-sync",
             f"--user-data-dir={folder}/p", size, "--virtual-time-budget=3000", f"--screenshot={picture}",
             f"file://{page}"],
            check=True,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip


def main(documentation, plots_of, height_px):
    """The whole program `SERIES.json PICTURE.png`."""
    if len(sys.argv) != 3:
        sys.exit(documentation)
    series = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))["series"]
    draw(plots_of(series), sys.argv[2], height_px)
