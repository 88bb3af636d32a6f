#!/usr/bin/env python3
"""cost_study_test.py ROOT BIN [CLASS]: the quick cost study of the cavity, killed and taken up, and on a cluster.

What is compared is what two runs of one study must share: every number of every answer, bit for bit. Their times are
not compared.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT, BIN = Path(sys.argv[1]), Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "validation" / "study"))

import plan as plans  # noqa: E402
from slurm_node import SlurmNode, what_is_missing  # noqa: E402

PLAN = plans.read(ROOT / "validation" / "cavity", quick=True)
RUNS = len(PLAN.points) + len(PLAN.levels())


def command(out: Path, *further) -> list:
    return ["/usr/bin/snakemake", "--snakefile", str(ROOT / "validation/study/cost.smk"), "--directory", str(out),
            "--rerun-incomplete", "--nolock", "--quiet", "rules", *map(str, further), "--config", "case=cavity",
            f"out={out}", "quick=yes", f"sph={BIN / 'sprung-sph'}", f"reference={BIN / 'sprung-reference'}"]


def run(out: Path, *further, environment=None) -> subprocess.CompletedProcess:
    return subprocess.run(command(out, *further), capture_output=True, text=True, env=environment, timeout=800)


def numbers(out: Path) -> dict:
    """What each answer holds, by its file: exact, as JSON keeps every bit of a double."""
    answers = {file.name: json.loads(file.read_text()) for file in sorted(out.glob("*/*.json"))}
    return {name: (one["outcome"], one["steps"], one["numbers"]) for name, one in answers.items()}


class StudyTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)

    def folder(self, name: str) -> Path:
        out = Path(self.scratch.name) / name
        out.mkdir()
        return out

    def whole(self, name: str, *further, environment=None) -> Path:
        out = self.folder(name)
        answer = run(out, *further, environment=environment)
        self.assertEqual(answer.returncode, 0, answer.stderr[-3000:])
        self.assertEqual(len(numbers(out)), RUNS)
        return out


class Resumed(StudyTest):
    def test_a_killed_study_goes_on_and_repeats_every_bit(self):
        out = self.folder("killed")
        child = subprocess.Popen(command(out, "--cores", "1"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                 start_new_session=True)
        for _ in range(6000):  # until a part of it is done
            if len(numbers(out)) >= 3 or child.poll() is not None:
                break
            time.sleep(0.05)
        self.assertIsNone(child.poll(), "the study ended before it could be killed")
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        before = {file: file.stat().st_mtime_ns for file in out.glob("*/*.json")}
        self.assertLess(len(before), RUNS)
        answer = run(out, "--cores", "1")
        self.assertEqual(answer.returncode, 0, answer.stderr[-3000:])
        again = [file.name for file, written in before.items() if file.stat().st_mtime_ns != written]
        self.assertLessEqual(len(again), 1, "only the last may run again, whose end Snakemake had not written down")
        self.assertEqual(numbers(out), numbers(self.whole("at_once", "--cores", "all")))

    def test_a_finished_study_runs_nothing(self):
        out = self.whole("finished", "--cores", "all")
        before = {file: file.stat().st_mtime_ns for file in out.glob("*/*.json")}
        self.assertEqual(run(out, "--cores", "all").returncode, 0)
        self.assertEqual({file: file.stat().st_mtime_ns for file in out.glob("*/*.json")}, before)


class OnSlurm(StudyTest):
    def test_the_same_file_runs_on_a_node_of_slurm(self):
        missing = what_is_missing()
        self.assertEqual(missing, "")
        with SlurmNode(self.folder("slurm")) as node:
            out = self.whole("by_slurm", "--profile", ROOT / "validation/study/slurm", environment=node.environment)
            jobs = list(out.glob("slurm-*.out"))
            self.assertEqual(len(jobs), RUNS, "every run is a job of Slurm's, and nothing else is")
        self.assertEqual(numbers(out), numbers(self.whole("here", "--cores", "all")))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
