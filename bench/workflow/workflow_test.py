# SPDX-License-Identifier: Apache-2.0
"""bench/workflow on this machine and on a Slurm of one node that the test starts.

A stand-in for ydd-slam, which does what `bench paper` promises in milliseconds, lets jobs be killed and
counted; one test runs the real program (YDD_BINARY). Skipped with a line where Snakemake or Slurm are missing.
"""
import importlib.util
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
# SLAM bench paper DATA --out OUT ... --plan | --gather | --one SEQUENCE VARIANT NUMBER
# DATA/fail: names of runs that fail, DATA/slow: seconds that each takes, DATA/made: a line for each that was made.
STUB = r"""
import pathlib, sys, time, json, os
a = sys.argv[1:]
data, out = pathlib.Path(a[2]), pathlib.Path(a[a.index("--out") + 1])
runs = [(s, v, str(n)) for n in range(1, int(a[a.index("--runs") + 1]) + 1) for s in ("one", "two") for v in ("off", "full")]
file = lambda r: out / "runs" / r[0] / f"{r[1]}-{r[2]}.json"
there = lambda r: file(r).exists() and file(r).read_text().endswith("}")
if "--plan" in a:
    for r in runs:
        print(*r, "there" if there(r) else "missing")
elif "--gather" in a:
    missing = [r for r in runs if not there(r)]
    (out / "paper.html").write_text(f"{len(runs) - len(missing)} runs")
    if missing:
        sys.exit(f"error: {len(missing)} of {len(runs)} runs are not there, the first: {' '.join(missing[0])}")
else:
    r = tuple(a[a.index("--one") + 1:][:3])
    name = f"{out.name}/{'/'.join(r)}"
    with open(data / "begun", "a") as f:
        f.write(name + "\n")
    slow = data / "slow"
    time.sleep(float(slow.read_text()) if slow.exists() else 0)
    broken = data / "fail"
    if broken.exists() and name in broken.read_text().split():
        sys.exit("error: a run that cannot be")
    file(r).parent.mkdir(parents=True, exist_ok=True)
    part = file(r).with_suffix(f".{os.getpid()}")
    options = dict(w.split("=") for w in a if "=" in w)
    x, y = float(options.get("x", 1)), int(options.get("y", 8))
    # Best at x = 3; y fits the noise of seed 1 alone.
    ate = 0.01 + 0.002 * (x - 3) ** 2 + (0.001 * y if r[2] == "1" else -0.0001 * y)
    lost = {} if "lost" in options and r[0] == "two" else {"ate_m.rmse": ate}
    part.write_text(json.dumps({"sequence": r[0], "run": int(r[2]), "variant": r[1],
                                "values": {"cpu_s": 2.0, "frames": 10, **lost}}))
    part.rename(file(r))
    with open(data / "made", "a") as f:
        f.write(name + "\n")
"""


def wait_until(condition, seconds=120):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return
        time.sleep(0.05)
    raise TimeoutError("what is waited for does not come")


@unittest.skipUnless(
    shutil.which("snakemake") and importlib.util.find_spec("yaml"),
    "no snakemake with python3-yaml here (Debian: apt-get install snakemake)",
)
class Workflow(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)
        self.data, self.out = self.root / "data", self.root / "out"
        self.data.mkdir()
        self.slam = self.root / "slam"
        self.slam.write_text(f"#!{sys.executable}\n{STUB}")
        self.slam.chmod(0o755)
        self.environment = {**os.environ, "HOME": str(self.root)}  # Snakemake keeps things there

    def config(self, **more):
        config = {"data": "data", "out": "out", "slam": "slam", "runs": 2, "configurations": {"a": {}, "b": {}}, **more}
        file = self.root / "matrix.yaml"
        file.write_text(json.dumps(config))  # JSON is YAML
        return file

    def start(self, *arguments, **more):
        command = [sys.executable, "-B", HERE / "run", self.config(**more), *arguments]
        return subprocess.Popen(
            list(map(str, command)),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env=self.environment,
            start_new_session=True,
        )

    def run_all(self, *arguments, **more):
        process = self.start(*arguments, **more)
        said = process.communicate(timeout=500)[0]
        return process.returncode, said

    def lines(self, name):
        file = self.data / name
        return file.read_text().splitlines() if file.exists() else []

    def results(self):
        return sorted(self.out.glob("*/runs/*/*.json"))

    def test_makes_everything_once_and_gathers_it(self):
        code, said = self.run_all("--cores", "4")
        self.assertEqual(code, 0, said)
        self.assertEqual(len(self.results()), 16)
        self.assertEqual(sorted(self.lines("made")), sorted(set(self.lines("made"))))
        self.assertEqual((self.out / "a/paper.html").read_text(), "8 runs")
        self.assertIn("16 runs took 32 core-seconds", said)
        # A second call makes only what is missing, damaged included.
        self.results()[3].unlink()
        self.results()[5].write_text('{"half":')
        code, said = self.run_all("--cores", "4")
        self.assertEqual(code, 0, said)
        self.assertEqual(len(self.lines("made")), 18)
        self.assertIn("damaged or of other settings", said)

    def test_what_fails_is_tried_again_and_named_and_the_rest_is_made(self):
        (self.data / "fail").write_text("b/two/full/1")
        code, said = self.run_all("--cores", "4", retries=2)
        self.assertEqual(code, 1)
        self.assertEqual(self.lines("begun").count("b/two/full/1"), 3)
        self.assertEqual(len(self.results()), 15)
        self.assertIn("b: 1 of 8 runs are not there, the first: two full 1", said)
        self.assertIn("a run that cannot be", (self.out / "b/logs/two/full-1.log").read_text())
        self.assertEqual((self.out / "b/paper.html").read_text(), "7 runs")
        (self.data / "fail").unlink()
        self.assertEqual(self.run_all("--cores", "4")[0], 0)
        self.assertEqual(len(self.lines("made")), 16)

    def test_controller_and_jobs_killed_in_the_middle_lose_nothing(self):
        (self.data / "slow").write_text("0.3")
        process = self.start("--cores", "2")
        wait_until(lambda: len(self.lines("made")) >= 3)
        os.killpg(process.pid, signal.SIGKILL)  # all of it, without a word
        process.communicate()
        made = self.lines("made")
        self.assertLess(len(made), 16)
        (self.data / "slow").unlink()
        code, said = self.run_all("--cores", "4")
        self.assertEqual(code, 0, said)
        self.assertEqual(len(self.results()), 16)
        self.assertEqual(len(self.lines("made")), len(set(self.lines("made"))), "something was made twice")

    def test_two_controllers_at_once_are_refused(self):
        (self.data / "slow").write_text("1")
        process = self.start("--cores", "1", runs=1)
        wait_until(lambda: self.lines("begun"))
        code, said = self.run_all("--cores", "1", runs=1)
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        self.assertEqual(code, 2)
        self.assertIn("another workflow works there", said)

    def test_bad_configurations_are_one_line(self):
        for more, word in (
            ({"configurations": {}}, "configurations"),
            ({"configurations": {"a/b": {}}}, "a/b"),
            ({"configurations": {"a": {"sets": []}}}, "sets"),
            ({"data": 3}, "data"),
            ({"seeds": 3}, "seeds"),
            ({"runs": 0}, "runs"),
            ({"retries": "two"}, "retries"),
            ({"threads": True}, "threads"),
            ({"slam": "nowhere"}, "no program"),
        ):
            with self.subTest(word=word):
                code, said = self.run_all(**more)
                self.assertEqual(code, 2, said)
                self.assertIn(word, said)
                self.assertEqual(said.count("\n"), 1, said)
        for text in ("[", "- 1", ""):
            file = self.root / "bad.yaml"
            file.write_text(text)
            done = subprocess.run([HERE / "run", file], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    @unittest.skipUnless(os.environ.get("YDD_BINARY"), "YDD_BINARY names no program")
    def test_the_real_program(self):
        slam = os.environ["YDD_BINARY"]
        sequence = self.data / "rgbd_dataset_freiburg3_walking_xyz"
        small = ["--frames", "12", "--set", "width=320", "--set", "height=240", "--quiet", "--jobs", "1"]
        subprocess.run([slam, "simulate", sequence, "--path", "xyz", "--busy", *small], check=True, capture_output=True)
        self.config()
        (self.root / "matrix.yaml").write_text(
            f"data: data\nout: out\nslam: {slam}\nruns: 1\nvariants: [off, full]\n"  # a bare off is false in YAML
            "configurations:\n  exact: {detector: recorded}\n  fewer: {detector: recorded, set: "
            "[dynamics.compensation.points=800]}\n"
        )
        command = [sys.executable, "-B", HERE / "run", self.root / "matrix.yaml", "--cores", "2"]
        done = subprocess.run(command, capture_output=True, text=True, env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("exact", "fewer"):
            paper = json.loads((self.out / name / "paper.json").read_text())
            self.assertIn("fr3_walking_xyz/full/ate_rmse_m", paper["groups"]["paper"]["figures"])
        costs = json.loads((self.out / "costs.json").read_text())
        self.assertEqual((costs["full"]["runs"], costs["full"]["frames"]), (2, 24))


def with_scipy():
    """A Python that has SciPy and YAML, or None."""
    for python in (sys.executable, "/usr/bin/python3"):
        if os.path.exists(python) and subprocess.run([python, "-c", "import scipy, yaml"], stderr=-3).returncode == 0:
            return python
    return None


@unittest.skipUnless(shutil.which("snakemake"), "no snakemake here (Debian: apt-get install snakemake)")
@unittest.skipUnless(with_scipy(), "no Python with SciPy here (Debian: apt-get install python3-scipy)")
class Tune(unittest.TestCase):
    setUp = Workflow.setUp
    lines = Workflow.lines

    def tune(self, **more):
        plan = {
            "data": "data",
            "out": "out",
            "slam": "slam",
            "variant": "full",
            "seeds": 1,
            "held_out_seeds": 1,
            "held_out_sequences": ["two"],
            "options": {"x": [0.0, 5.0]},
            "proposals": 15,
            "seed": 4,
            **more,
        }
        (self.root / "tune.yaml").write_text(json.dumps(plan))
        command = [with_scipy(), "-B", HERE / "tune", self.root / "tune.yaml", "--cores", "8"]
        return subprocess.run(list(map(str, command)), capture_output=True, text=True, env=self.environment)

    def tuned(self):
        return json.loads((self.out / "tuned.json").read_text())

    def test_finds_what_is_better_and_sees_it_on_what_was_held_out(self):
        done = self.tune()
        self.assertEqual(done.returncode, 0, done.stderr)
        best = float(self.tuned()["best"][0].removeprefix("x="))
        self.assertLess(abs(best - 3), 1.2)
        for part in ("tuned_on", "held_out_seeds", "held_out_sequences"):
            self.assertGreater(self.tuned()[part]["gain_per_cent"], 10, part)
        # Everything is there: the same call runs nothing.
        made = len(self.lines("made"))
        self.assertEqual(self.tune().returncode, 0)
        self.assertEqual(len(self.lines("made")), made)

    def test_overfit_is_told(self):
        done = self.tune(options={"y": [0, 9]}, proposals=5)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = self.tuned()
        self.assertGreater(result["tuned_on"]["gain_per_cent"], 5)
        self.assertLess(result["held_out_seeds"]["gain_per_cent"], 0)
        self.assertGreater(result["overfit_per_cent"], 5)
        self.assertIn("overfit or luck", done.stdout)

    def test_nothing_better_is_told_as_well(self):
        done = self.tune(options={"y": [9, 20]}, proposals=5)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("nothing better than the defaults", done.stdout)

    def test_bad_plans_are_one_line(self):
        for more in (
            {"options": {}},
            {"options": {"x": [3, 1]}},
            {"options": {"x": 3}},
            {"seeds": 0},
            {"data": 1},
            {"slam": "nowhere"},
        ):
            with self.subTest(more=more):
                done = self.tune(**more)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


SLURM = {"slurmctld": "slurmctld", "slurmd": "slurmd", "munged": "munge", "sbatch": "slurm-client"}
PATH = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


@unittest.skipUnless(
    all(shutil.which(p, path=PATH) for p in SLURM),
    f"no Slurm here (Debian: apt-get install {' '.join(dict.fromkeys(SLURM.values()))})",
)
@unittest.skipUnless(os.geteuid() == 0, "Slurm's daemons want root")
class OnSlurm(Workflow):
    """The same on a cluster of one node: munged, slurmctld and slurmd of this test's own."""

    def setUp(self):
        super().setUp()
        self.daemons = []
        self.addCleanup(self.stop_daemons)
        self.spool = self.root / "slurm"
        self.spool.mkdir()
        self.write_configuration()
        self.start_munge()
        self.start_controller()
        self.start_daemon("slurmd", "-D", "-f", self.spool / "slurm.conf", "-N", self.host)
        wait_until(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%t"), 60)

    def write_configuration(self):
        self.host = socket.gethostname().split(".")[0]
        cores = os.cpu_count()
        self.environment |= {"SLURM_CONF": str(self.spool / "slurm.conf"), "PATH": PATH}
        (self.spool / "slurm.conf").write_text(
            f"""
ClusterName=test
SlurmctldHost={self.host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={self.spool}/munge.socket
CredType=cred/munge
StateSaveLocation={self.spool}/state
SlurmdSpoolDir={self.spool}/spool
SlurmctldPidFile={self.spool}/slurmctld.pid
SlurmdPidFile={self.spool}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SlurmdTimeout=300
MinJobAge=300
NodeName={self.host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory=4000 State=UNKNOWN
PartitionName=all Nodes={self.host} Default=YES MaxTime=INFINITE State=UP
"""
        )

    def start_munge(self):
        key = self.spool / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        self.spool.chmod(0o755)
        self.start_daemon(
            "munged",
            "--foreground",
            "--force",
            "--key-file",
            key,
            "--socket",
            self.spool / "munge.socket",
            "--pid-file",
            self.spool / "munged.pid",
            "--log-file",
            self.spool / "munged.log",
            "--seed-file",
            self.spool / "munged.seed",
        )
        wait_until(lambda: (self.spool / "munge.socket").exists(), 30)

    def start_controller(self):
        self.controller = self.start_daemon("slurmctld", "-D", "-f", self.spool / "slurm.conf")
        wait_until(lambda: self.ask("scontrol", "ping").count("UP"), 60)

    def start_daemon(self, *command):
        log = open(self.spool / f"{command[0]}.out", "ab")
        self.addCleanup(log.close)
        process = subprocess.Popen(
            [str(c) for c in command], stdout=log, stderr=log, env=self.environment, cwd=self.spool
        )
        self.daemons.append(process)
        return process

    def stop_daemons(self):
        for process in reversed(self.daemons):
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def ask(self, *command):
        return subprocess.run(command, capture_output=True, text=True, env=self.environment).stdout

    def run_all(self, *arguments, **more):
        return super().run_all("--slurm", "--", "--latency-wait", "5", **{"threads": 1, "mem_mb": 100, **more})

    def start(self, *arguments, **more):
        arguments = arguments if "--slurm" in arguments else ("--slurm",)
        return super().start(*arguments, **{"threads": 1, "mem_mb": 100, **more})

    def test_controller_and_jobs_killed_in_the_middle_lose_nothing(self):
        (self.data / "slow").write_text("8")
        process = self.start("--slurm")
        wait_until(lambda: len(self.lines("made")) >= 2)
        # Slurm writes down what it knows every few seconds; a job that it does not know of any more drains
        # the node, which is an administrator's business and not ours.
        wait_until(lambda: len(self.lines("begun")) >= 4)
        time.sleep(6)
        os.killpg(process.pid, signal.SIGKILL)  # Snakemake; its jobs stay in the queue and run on
        process.communicate()
        self.controller.kill()  # and Slurm's own controller
        self.controller.wait()
        running = self.lines("begun")
        self.start_controller()
        self.ask("scancel", "--signal=KILL", "--full", *self.ask("squeue", "-h", "-t", "R", "-o", "%i").split()[:1])
        (self.data / "slow").write_text("0.1")
        code, said = self.run_all()
        self.assertEqual(code, 0, said)
        self.assertGreater(len(running), 0)
        self.assertEqual(len(self.results()), 16)
        self.assertEqual(len(self.lines("made")), len(set(self.lines("made"))), "something was made twice")

    test_two_controllers_at_once_are_refused = None
    test_bad_configurations_are_one_line = None
    test_the_real_program = None


if __name__ == "__main__":
    unittest.main()
