#!/usr/bin/env python3
"""refusal_test.py PROGRAMS ROOT: bad scenes are refused, by checking and by running, and leave nothing behind.

The scenes stand in refusals.toml. Each must be refused with a non-zero exit code that is no crash, and a message
with file, line, the value seen and the remedy; no output folder may exist afterwards.
"""

import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

PROGRAMS, ROOT = (Path(a) for a in sys.argv[1:3])
SCENE = ROOT / "validation/beam_in_channel/scene.toml"
REFUSALS = tomllib.loads((Path(__file__).with_name("refusals.toml")).read_text())["refusal"]
SPH, REFERENCE = PROGRAMS / "sprung-sph", PROGRAMS / "sprung-reference"


def line_with(text: str, part: str) -> int:
    return next(number for number, line in enumerate(text.splitlines(), 1) if part in line)


class RefusalTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="sprung_refusal_")
        self.folder = Path(self.temporary.name)
        self.out = self.folder / "out"

    def tearDown(self):
        self.temporary.cleanup()

    def commands(self, solvers: list[str], scene: Path, *overrides: str) -> list[list]:
        commands = []
        if "sph" in solvers:
            commands += [[SPH, "check", scene, *overrides], [SPH, "run", scene, *overrides, "--out", self.out]]
        if "reference" in solvers and REFERENCE.exists():
            commands.append([REFERENCE, scene, *overrides, "--out", self.out])
        return commands

    def assert_refused(self, commands: list[list], says: list[str]):
        for command in commands:
            with self.subTest(program=command[0].name, verb=str(command[1])):
                answer = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=60)
                self.assertGreater(answer.returncode, 0, "not refused, or crashed: " + answer.stderr)
                self.assertLess(answer.returncode, 100, "crashed: " + answer.stderr)
                for text in says:
                    self.assertIn(text, answer.stderr)
                self.assertFalse(self.out.exists(), "left an output folder behind")

    def test_bad_scenes(self):
        good = SCENE.read_text()
        for refusal in REFUSALS:
            with self.subTest(refusal["name"]):
                self.assertEqual(good.count(refusal["replace"]), 1, "the scene has changed: mend refusals.toml")
                bad = good.replace(refusal["replace"], refusal["by"])
                scene = self.folder / "bad.toml"
                scene.write_text(bad)
                line = line_with(bad, refusal.get("line_of", refusal["by"].splitlines()[0]))
                self.assert_refused(self.commands(refusal["solvers"], scene), [f"bad.toml:{line}", *refusal["says"]])

    def test_missing_file(self):
        scene = self.folder / "nowhere.toml"
        self.assert_refused(self.commands(["sph", "reference"], scene), ["nowhere.toml"])

    def test_bad_overrides(self):
        for override, says in (
            ("solid.beam.youngs_modulus=0.7 mm", ["0.7 mm", "command line"]),
            ("solid.beam.colour=red", ["colour", "command line"]),
            ("end=3 s", ["end"]),
        ):
            with self.subTest(override):
                self.assert_refused(self.commands(["sph", "reference"], SCENE, override), says)

    def test_options_that_are_no_finite_numbers(self):
        for program, *words in (("sprung-calibrate", "cube", "--stress", "nan", "--out"),
                                ("sprung-calibrate", "hold", "--seconds=nan", "--out"),
                                ("sprung-reference-solid", "--youngs-modulus", "inf", "--out"),
                                ("sprung-reference-solid", "--youngs-modulus=3e6", "--shear", "nan", "--out")):
            if (PROGRAMS / program).exists():
                self.assert_refused([[PROGRAMS / program, *words, self.out]], [words[-2]])

    def test_the_good_scene_is_sound(self):
        answer = subprocess.run([SPH, "check", SCENE], capture_output=True, text=True, timeout=60)
        self.assertEqual(answer.returncode, 0, answer.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
