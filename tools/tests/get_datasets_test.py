# SPDX-License-Identifier: Apache-2.0
"""tools/get-datasets against a local server with the publishers' layout, and with its bad days."""
import hashlib
import http.server
import io
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile
import threading
import unittest
import zipfile

TOOLS = pathlib.Path(__file__).resolve().parent.parent
TUM = "/rgbd/dataset/freiburg3/rgbd_dataset_freiburg3_walking_xyz.tgz"
FOLDER = "rgbd_dataset_freiburg3_walking_xyz"


def tgz(files):
    """A tar of {name: bytes}; of TarInfo as they are."""
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w:gz") as tar:
        for name, content in files.items():
            info = name if isinstance(name, tarfile.TarInfo) else tarfile.TarInfo(name)
            info.size = len(content)
            tar.addfile(info, io.BytesIO(content))
    return out.getvalue()


def sequence(folder, seed=0):
    prefix = f"{folder}/" if folder else ""
    noise = b"".join(hashlib.sha256(b"%d %d" % (seed, i)).digest() for i in range(4000))  # cannot be packed
    return {f"{prefix}rgb.txt": b"1.0 rgb/1.png\n", f"{prefix}rgb/1.png": noise, f"{prefix}depth.txt": b"1.0 d\n"}


class Server(http.server.ThreadingHTTPServer):
    """Files by path. What goes wrong is said by the members."""

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.files, self.moved, self.pages = {}, {}, set()
        self.cut_after = None  # bytes of each answer
        self.fail_first = 0  # answers with 503
        self.ranges = True
        self.etag = True
        self.asked = []  # (path, Range)
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def handle_error(self, request, client_address):
        pass  # connections that are cut on purpose


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *arguments):
        pass

    def answer(self, code, headers):
        self.send_response(code)
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()

    def do_GET(self):
        server = self.server
        server.asked.append((self.path, self.headers.get("Range")))
        if server.fail_first > 0:
            server.fail_first -= 1
            return self.answer(503, {"Content-Length": 0})
        if self.path in server.moved:
            return self.answer(302, {"Location": server.moved[self.path], "Content-Length": 0})
        if self.path in server.pages:
            self.answer(200, {"Content-Type": "text/html", "Content-Length": 5})
            return self.wfile.write(b"<html")
        if self.path not in server.files:
            return self.answer(404, {"Content-Length": 0})
        content = server.files[self.path]
        etag = '"%s"' % hashlib.sha256(content).hexdigest()[:16]
        headers = {"Content-Type": "application/x-gzip"}
        if server.etag:
            headers["ETag"] = etag
        match = re.fullmatch(r"bytes=(\d+)-", self.headers.get("Range") or "")
        begin = int(match[1]) if match and server.ranges and self.headers.get("If-Range", etag) == etag else 0
        if begin >= len(content) and match:
            return self.answer(416, {"Content-Length": 0})
        headers["Content-Length"] = len(content) - begin
        if begin:
            headers["Content-Range"] = f"bytes {begin}-{len(content) - 1}/{len(content)}"
        self.answer(206 if begin else 200, headers)
        rest = content[begin:]
        if server.cut_after is not None and len(rest) > server.cut_after:
            self.wfile.write(rest[: server.cut_after])
            self.close_connection = True
            return None
        return self.wfile.write(rest)


class GetDatasets(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.to = pathlib.Path(scratch.name) / "datasets"
        self.server = Server()
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        self.base = f"http://127.0.0.1:{self.server.server_port}"
        self.server.files[TUM] = tgz(sequence(FOLDER))

    def get(self, *names, any_size=True):
        command = [sys.executable, "-B", TOOLS / "get-datasets", "--to", self.to, "--pause", "0", "--tries", "3"]
        for publisher in ("https://cvg.cit.tum.de", "https://www.ipb.uni-bonn.de", "https://www.doc.ic.ac.uk"):
            command += ["--from", f"{publisher}={self.base}"]
        command += ["--any-size"] if any_size else []
        # Whoever sits behind a proxy still reaches this machine.
        environment = {"PATH": "/usr/bin:/bin", "no_proxy": "*"}
        return subprocess.run([*map(str, command), *names], capture_output=True, text=True, env=environment)

    def left(self):
        return sorted(p.name for p in self.to.iterdir()) if self.to.exists() else []

    def assert_failed(self, done, *words):
        self.assertEqual(done.returncode, 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertFalse((self.to / FOLDER).exists())

    def assert_whole(self, folder=FOLDER):
        self.assertEqual((self.to / folder / "rgb/1.png").read_bytes(), sequence("")["rgb/1.png"])
        self.assertEqual(self.left(), [folder])

    def test_brings_unpacks_says_the_licence_and_does_it_once(self):
        done = self.get("fr3_walking_xyz")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("CC BY 4.0", done.stderr)
        self.assert_whole()
        again = self.get("fr3_walking_xyz")
        self.assertEqual(again.returncode, 0)
        self.assertIn("is there", again.stderr)
        self.assertEqual(len(self.server.asked), 1)

    def test_zip_of_bonn_and_archive_without_folder_of_icl(self):
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as z:
            for name, content in sequence("rgbd_bonn_crowd").items():
                z.writestr(name, content)
        self.server.files["/html/projects/rgbd_dynamic2019/rgbd_bonn_crowd.zip"] = packed.getvalue()
        self.server.files["/~ahanda/living_room_traj0_frei_png.tar.gz"] = tgz(
            {("./" + n).replace("rgb.txt", "associations.txt"): c for n, c in sequence("").items()}
        )
        done = self.get("bonn_crowd", "icl_living_room_0")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.left(), ["icl_living_room_0", "rgbd_bonn_crowd"])
        self.assertIn("ICL-NUIM: CC BY 3.0", done.stderr)

    def test_goes_on_where_connections_end(self):
        self.server.cut_after = 50000
        done = self.get("fr3_walking_xyz")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_whole()
        self.assertEqual([r for _, r in self.server.asked], [None, "bytes=50000-", "bytes=100000-"])

    def test_goes_on_in_a_second_call(self):
        self.server.cut_after = 0  # after the head of the answer nothing comes
        self.assert_failed(self.get("fr3_walking_xyz"), "the same command goes on")
        self.server.cut_after = 60000
        self.server.fail_first = 1
        done = self.get("fr3_walking_xyz")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_whole()

    def test_a_file_that_changes_meanwhile_is_begun_anew(self):
        whole = self.server.files[TUM]
        self.to.mkdir()
        old = tgz(sequence(FOLDER, seed=7))
        (self.to / f"{FOLDER}.tgz.part").write_bytes(old[:50000])
        (self.to / f"{FOLDER}.tgz.part.json").write_text('{"mark": "\\"other\\""}')
        done = self.get("fr3_walking_xyz")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("begins anew", done.stderr)
        self.assertEqual(self.server.files[TUM], whole)
        self.assert_whole()

    def test_a_part_that_is_longer_than_the_file_or_without_notes_is_begun_anew(self):
        for notes in (None, "{", "3", '{"mark": "\\"%s\\""}' % hashlib.sha256(self.server.files[TUM]).hexdigest()[:16]):
            with self.subTest(notes=notes):
                self.to.mkdir(exist_ok=True)
                (self.to / f"{FOLDER}.tgz.part").write_bytes(b"x" * 10**6)
                if notes:
                    (self.to / f"{FOLDER}.tgz.part.json").write_text(notes)
                done = self.get("fr3_walking_xyz")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assert_whole()
                subprocess.run(["rm", "-r", str(self.to)], check=True)

    def test_a_server_without_ranges_or_marks_still_brings_the_file(self):
        self.server.ranges = self.server.etag = False
        self.assertEqual(self.get("fr3_walking_xyz").returncode, 0)
        self.assert_whole()

    def test_wrong_size_is_named_and_nothing_is_kept(self):
        done = self.get("fr3_walking_xyz", any_size=False)
        self.assert_failed(done, f"has {len(self.server.files[TUM])} bytes, 527550055 are expected", "--any-size")
        self.assertEqual(self.left(), [])

    def test_a_moved_file_is_followed(self):
        self.server.files["/new/place.tgz"] = self.server.files.pop(TUM)
        self.server.moved[TUM] = self.base + "/new/place.tgz"
        self.assertEqual(self.get("fr3_walking_xyz").returncode, 0)
        self.assert_whole()

    def test_a_file_that_is_gone_is_named_with_the_publishers_page(self):
        del self.server.files[TUM]
        done = self.get("fr3_walking_xyz")
        self.assert_failed(done, "HTTP 404", "https://cvg.cit.tum.de/data/datasets/rgbd-dataset", "--from")
        self.assertEqual(len(self.server.asked), 1)  # no use in asking again

    def test_a_page_instead_of_the_file(self):
        self.server.pages.add(TUM)
        self.assert_failed(self.get("fr3_walking_xyz"), "a page came instead of the file")

    def test_servers_that_rest_are_asked_again_but_not_for_ever(self):
        self.server.fail_first = 2
        self.assertEqual(self.get("fr3_walking_xyz").returncode, 0)
        subprocess.run(["rm", "-r", str(self.to)], check=True)
        self.server.fail_first = 1000
        self.assert_failed(self.get("fr3_walking_xyz"), "HTTP 503")

    def test_nobody_there(self):
        self.base = "http://127.0.0.1:9"
        self.assert_failed(self.get("fr3_walking_xyz"), "fr3_walking_xyz:")

    def test_archives_of_no_use_are_dropped_and_nothing_half_is_left(self):
        link = tarfile.TarInfo(f"{FOLDER}/link")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        whole = self.server.files[TUM]
        for content, word in (
            (tgz({"../evil.txt": b"x"}), "leads out of its folder"),
            (tgz({"/tmp/evil.txt": b"x"}), "leads out of its folder"),
            (tgz({link: b""}), "neither file nor folder"),
            (tgz({f"{FOLDER}/readme": b"x"}), "no rgb.txt"),
            (b"no archive at all", "neither a tgz nor a zip"),
            (whole[: len(whole) // 2], ""),
            (whole[:20000] + bytes(1000) + whole[21000:], ""),
        ):
            with self.subTest(word=word, size=len(content)):
                self.server.files[TUM] = content
                self.assert_failed(self.get("fr3_walking_xyz"), word, "dropped")
                self.assertEqual(self.left(), [])
                self.assertFalse((self.to.parent / "evil.txt").exists())

    def test_one_that_fails_does_not_keep_the_others(self):
        done = self.get("fr1_xyz", "fr3_walking_xyz")
        self.assertEqual(done.returncode, 1)
        self.assertIn("fr1_xyz", done.stderr)
        self.assert_whole()

    def test_names(self):
        self.assertEqual(self.get("no_such_set").returncode, 2)
        self.assertEqual(self.get().returncode, 2)
        done = self.get("openloris")
        self.assertEqual(done.returncode, 1)
        self.assertIn("form", done.stderr)
        listed = self.get("--list").stdout
        article = [line.split()[0] for line in listed.splitlines() if ",article" in line]
        self.assertEqual(len(article), 5)
        self.assertEqual(self.server.asked, [])


if __name__ == "__main__":
    unittest.main()
