# SPDX-License-Identifier: Apache-2.0
"""Tests of the scripts around bench/results/results.json."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TOOLS))
sys.dont_write_bytecode = True
import ydd_results as results  # noqa: E402


def document(machine="a", **figures):
    """A file of one group. A figure is the list of its runs."""
    made = {n.replace("__", "/"): results.figure(n, r) for n, r in figures.items()}
    return {"groups": {"g": {"commit": "c", "date": "d", "machine": {"processor": machine}, "figures": made}}}


class Folder(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def write(self, name, content):
        path = self.folder / name
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return str(path)

    def tool(self, name, *arguments):
        return subprocess.run(
            [sys.executable, "-B", TOOLS / name, *map(str, arguments)], capture_output=True, text=True
        )


class CompareResults(Folder):
    def compare(self, a, b, *arguments):
        return self.tool("compare-results", self.write("a.json", a), self.write("b.json", b), *arguments)

    def test_worse_beyond_the_spread_is_exit_1(self):
        done = self.compare(
            document(s__ate_rmse_m=[0.010, 0.011, 0.012]), document(s__ate_rmse_m=[0.014, 0.015, 0.016])
        )
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("worse  g/s/ate_rmse_m: 0.011 (0.01 - 0.012) -> 0.015 (0.014 - 0.016) m", done.stdout)

    def test_runs_that_overlap_are_the_same(self):
        done = self.compare(
            document(s__ate_rmse_m=[0.010, 0.011, 0.015]), document(s__ate_rmse_m=[0.014, 0.015, 0.016])
        )
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("0 worse, 0 better, 1 same", done.stdout)

    def test_better_is_told_and_exit_0(self):
        done = self.compare(
            document(s__recall=[0.95], s__ate_rmse_m=[0.02]), document(s__recall=[0.97], s__ate_rmse_m=[0.01])
        )
        self.assertEqual(done.returncode, 0)
        self.assertIn("0 worse, 2 better, 0 same", done.stdout)

    def test_a_lower_share_is_worse(self):
        self.assertEqual(
            self.compare(document(s__tracked_share=[1.0]), document(s__tracked_share=[0.98])).returncode, 1
        )

    def test_less_than_anybody_cares_for_is_the_same(self):
        a, b = document(s__ate_rmse_m=[0.0010]), document(s__ate_rmse_m=[0.00109])
        self.assertEqual(self.compare(a, b).returncode, 0)
        a, b = document(s__ate_rmse_m=[0.100]), document(s__ate_rmse_m=[0.104])
        self.assertEqual(self.compare(a, b).returncode, 0)
        self.assertEqual(self.compare(a, b, "--margin", 0.01).returncode, 1)

    def test_a_figure_that_cannot_be_measured_any_more_is_worse(self):
        done = self.compare(document(s__ate_rmse_m=[0.01]), document(s__ate_rmse_m=[]))
        self.assertEqual(done.returncode, 1)
        self.assertIn("-> no figure", done.stdout)

    def test_times_of_another_machine_are_not_compared(self):
        a, b = document("a", s__total_ms=[5.0], s__ate_rmse_m=[0.01]), document(
            "b", s__total_ms=[50.0], s__ate_rmse_m=[0.01]
        )
        done = self.compare(a, b)
        self.assertEqual(done.returncode, 0)
        self.assertIn("times of two machines: 1 (g/s/total_ms)", done.stdout)
        self.assertEqual(self.compare(a, document("a", s__total_ms=[50.0])).returncode, 1)

    def test_what_one_file_lacks_is_named(self):
        done = self.compare(
            document(s__ate_rmse_m=[0.01], t__ate_rmse_m=[0.01]), document(s__ate_rmse_m=[0.01], u__ate_rmse_m=[1])
        )
        self.assertEqual(done.returncode, 0)
        self.assertIn("not in B: 1 (g/t/ate_rmse_m)", done.stdout)
        self.assertIn("not in A: 1 (g/u/ate_rmse_m)", done.stdout)

    def test_files_without_a_figure_in_common_are_no_pass(self):
        self.assertEqual(self.compare(document(s__ate_rmse_m=[0.01]), document(t__ate_rmse_m=[0.01])).returncode, 2)

    def test_unusable_files_are_one_line_and_exit_2(self):
        whole = document(s__ate_rmse_m=[0.01])
        crossed = json.loads(json.dumps(whole))
        crossed["groups"]["g"]["figures"]["s/ate_rmse_m"]["min"] = 7
        half = json.dumps(whole)[:60]
        for damaged in (
            "",
            "[]",
            "{}",
            half,
            '{"groups": []}',
            '{"groups": {"g": 3}}',
            crossed,
            '{"groups": {"g": {"figures": {"x": {"better": "lower", "median": "1", "min": 0, "max": 2}}}}}',
        ):
            done = self.compare(whole, damaged)
            self.assertEqual(done.returncode, 2, damaged)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn("b.json", done.stderr)
        self.assertEqual(self.tool("compare-results", "/nowhere/a", "/nowhere/b").returncode, 2)


class MeasureResults(Folder):
    ABLATION = [
        {
            "sequence": "s",
            "variant": "off",
            "ate_rmse_m": {"median": 2, "min": 1, "max": 3, "runs": [1, 2, 3]},
            "tracked_share": {"median": 1, "min": 1, "max": 1, "runs": [1, 1, 1]},
        }
    ]

    def test_takes_the_json_of_a_bench_and_keeps_other_groups(self):
        out = self.write("results.json", document(s__ate_rmse_m=[0.01]))
        done = self.tool(
            "measure-results",
            "--out",
            out,
            "--take",
            "ablation=" + self.write("bench.json", self.ABLATION),
            "--commit",
            "abc",
            "--machine",
            "a small one",
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        made = results.load(out)
        self.assertIn("g", made["groups"])
        group = made["groups"]["ablation"]
        self.assertEqual((group["commit"], group["machine"]["processor"]), ("abc", "a small one"))
        self.assertEqual(
            group["figures"]["s/off/ate_rmse_m"],
            {"unit": "m", "better": "lower", "median": 2, "min": 1, "max": 3, "runs": [1, 2, 3]},
        )

    def test_a_bench_that_could_not_score_gives_no_figure_rather_than_zero(self):
        lost = [{"sequence": "s", "variant": "off", "ate_rmse_m": {"median": 0.0, "min": 0.0, "max": 0.0, "runs": []}}]
        out = self.folder / "results.json"
        self.tool("measure-results", "--out", out, "--take", "ablation=" + self.write("bench.json", lost))
        self.assertIsNone(results.load(out)["groups"]["ablation"]["figures"]["s/off/ate_rmse_m"]["median"])

    def test_json_of_something_else_leaves_the_file_as_it_was(self):
        out = self.write("results.json", document(s__ate_rmse_m=[0.01]))
        before = pathlib.Path(out).read_text()
        for content in ("{", "3", "[]", '{"a": 1}', "[3]", "null"):
            done = self.tool("measure-results", "--out", out, "--take", "ablation=" + self.write("bench.json", content))
            self.assertEqual(done.returncode, 1, content)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertEqual(pathlib.Path(out).read_text(), before)

    def test_measures_with_the_program_and_says_where_it_comes_from(self):
        bench = self.write(
            "slam",
            f"#!{sys.executable}\nimport json, sys\n"
            f"open(sys.argv[sys.argv.index('--out') + 1], 'w').write(json.dumps({self.ABLATION!r}))\n",
        )
        pathlib.Path(bench).chmod(0o755)
        out = self.folder / "results.json"
        done = self.tool("measure-results", "--slam", bench, "--out", out, "--only", "ablation", "--data", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("not here, left out: crowd_xyz", done.stderr)
        group = results.load(out)["groups"]["ablation"]
        self.assertIn("bench ablation office_crowd", group["command"])
        self.assertEqual(group["machine"], results.machine())
        self.assertEqual(self.tool("compare-results", out, out).returncode, 0)

    def test_reads_what_the_benches_write(self):
        kind = {
            "wanted": 4,
            "found": 3,
            "told": 3,
            "false": 1,
            "across_m": {"median": 0.1, "p95": 0.2},
            "velocity_m_s": {"median": 0.1, "p95": 0.3},
        }
        documents = {
            "tracks": ({"busy": kind}, "busy/found", 0.75),
            "places": (
                [{"world": "w", "top1_recall": 1, "verified_recall": 0.9, "verified_wrong": 2}],
                "w/verified_false",
                2,
            ),
            "scale": ({"series": [{"keyframes": 1005, "query_ms": 0.5}]}, "about 1000 keyframes/query_ms", 0.5),
            "boxes": ([{"sequence": "s", "boxes": "none", "ate_rmse_m": [3, 1, 2]}], "s/none/ate_rmse_m", 2),
            "motion": (
                {
                    "frames_to_find": [{"speed_m_s": 1.0, "distance_m": 2.5, "frames": [5, 7, 6]}],
                    "rigid": {"false_alarms": 0},
                },
                "1.0 m per s at 2.5 m/frames",
                6,
            ),
            "recovery": (
                [{"accident": "a", "runs": 4, "found": 3, "frames": [1], "ate_rmse_m": [1], "false_places": 0}],
                "a/found",
                0.75,
            ),
        }
        out = self.folder / "results.json"
        for group, (document, name, median) in documents.items():
            done = self.tool("measure-results", "--out", out, "--take", f"{group}=" + self.write("b.json", document))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(results.load(out)["groups"][group]["figures"][name]["median"], median)

    def test_a_bench_that_fails_is_named(self):
        out = self.folder / "results.json"
        done = self.tool("measure-results", "--slam", "/bin/false", "--out", out, "--only", "motion")
        self.assertEqual(done.returncode, 1)
        self.assertIn("group motion", done.stderr)
        self.assertFalse(out.exists())


class ReadmeTables(Folder):
    GROUPS = {
        "groups": {
            g: {
                "commit": "c",
                "date": "d",
                "machine": {},
                "command": "x",
                "figures": {f"crowd_xyz/{v}/ate_rmse_m": results.figure("ate_rmse_m", [0.01, 0.02, 0.03])},
            }
            for g, v in (("ablation", "off"), ("network", "full"), ("detectors", "ydd"))
        }
    }
    README = "".join(
        f"before\n<!-- table {t} -->\n<!-- /table -->\nafter\n" for t in ("exact_boxes", "network", "detectors")
    )

    def test_the_readme_of_the_project_is_what_its_file_gives(self):
        done = self.tool("readme-tables", "--check")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_writes_between_the_markers_and_nowhere_else(self):
        readme, file = self.write("README.md", self.README), self.write("r.json", self.GROUPS)
        arguments = ("--readme", readme, "--results", file)
        self.assertEqual(self.tool("readme-tables", "--check", *arguments).returncode, 1)
        self.assertEqual(self.tool("readme-tables", *arguments).returncode, 0)
        text = pathlib.Path(readme).read_text()
        self.assertIn("| crowd_xyz | 0.0200 (0.0100 - 0.0300) |  |", text)
        self.assertEqual(text.count("before\n<!-- table"), 3)
        self.assertEqual(self.tool("readme-tables", "--check", *arguments).returncode, 0)
        pathlib.Path(readme).write_text(text.replace("0.0200", "0.0199", 1))
        done = self.tool("readme-tables", "--check", *arguments)
        self.assertEqual(done.returncode, 1)
        self.assertIn("exact_boxes", done.stderr)

    def test_markers_that_are_gone_or_unknown_are_named(self):
        file = self.write("r.json", self.GROUPS)
        for text, word in ((self.README.replace("table network", "table other"), "other"), ("nothing", "exact_boxes")):
            done = self.tool("readme-tables", "--check", "--readme", self.write("README.md", text), "--results", file)
            self.assertEqual(done.returncode, 1)
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main()
