#!/usr/bin/env python3
"""cases_test.py ROOT SPRUNG_SPH: every case with a verification.toml is whole, and its scenes are accepted.

A run takes minutes; a misspelt probe, spacing or override must not wait for it.
"""

import subprocess
import sys
import unittest
from pathlib import Path

ROOT, PROGRAM = Path(sys.argv[1]), sys.argv[2]
sys.path.insert(0, str(ROOT / "validation" / "verify"))

import exact  # noqa: E402
import measures  # noqa: E402
import verify  # noqa: E402
from scene import Scene  # noqa: E402

CASES = sorted(file.parent for file in (ROOT / "validation").glob("*/verification.toml"))


class CasesTest(unittest.TestCase):
    def test_there_are_cases(self):
        self.assertGreaterEqual(len(CASES), 10)

    def test_scenes_are_accepted_at_their_coarsest_spacing(self):  # finer ones take long to set up
        for case in CASES:
            for name, series in verify.read_case(case)["series"].items():
                with self.subTest(f"{case.name} {name}"):
                    arguments = verify.arguments_of(series, series["spacings"][0], [])
                    answer = subprocess.run([PROGRAM, "check", case / series.get("scene", "scene.toml"), *arguments],
                                            capture_output=True, text=True)
                    self.assertEqual(answer.returncode, 0, answer.stderr)

    def test_checks_name_what_there_is(self):
        for case in CASES:
            for name, series in verify.read_case(case)["series"].items():
                scene = Scene.of_toml((case / series.get("scene", "scene.toml")).read_text())
                for check_name, check in series["check"].items():
                    with self.subTest(f"{case.name} {name} {check_name}"):
                        if "probe" in check:
                            self.assertTrue(scene.has(f"probes.{check['probe']}"), check["probe"])
                        if "exact" in check:
                            self.assertIn(check["exact"], exact.SOLUTIONS)
                        if "file" in check:
                            table = measures.read_literature(case / "literature" / check["file"])
                            self.assertTrue({check["along"], check["column"]} <= set(table))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
