#!/usr/bin/env python3
"""driver_test.py ROOT: the verification driver on a solver made of formulas, whose error and order are known."""

import json
import math
import os
import subprocess
import sys
import tempfile
import tomllib
import types
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "validation" / "verify"))

import hard_measures  # noqa: E402

HERE = ROOT / "tests" / "unit" / "verification"
CASE = ROOT / "validation" / "start_up_poiseuille"

VERIFICATION = """
title = "a case"
[series.one]
title = "a series"
spacings = ["100 mm", "50 mm", "25 mm"]
[series.one.check.profile]
says = "velocity"
kind = "profile"
probe = "section"
exact = "forced_channel"
scale = "1 m/s"
limits = [{ at = "50 mm", most = 0.0026, because = "(50 mm)^2 and a little" },
          { at = "25 mm", most = 0.0006, because = "below (25 mm)^2: must fail" }]
order = { from = 1.9, to = 2.1, because = "the formula's order is 2" }
[series.one.processor_time]
at = "50 mm"
most = 2.0
because = "the formula says 1.5"
"""


class DriverTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="sprung_verify_")
        self.addCleanup(temporary.cleanup)
        self.case, self.out = Path(temporary.name) / "case", Path(temporary.name) / "out"
        self.case.mkdir()
        (self.case / "scene.toml").write_text((CASE / "scene.toml").read_text())
        self.write(VERIFICATION)

    def write(self, text: str) -> None:
        (self.case / "verification.toml").write_text(text)

    def retitle(self, title: str) -> None:
        text = (CASE / "scene.toml").read_text().splitlines()
        (self.case / "scene.toml").write_text("\n".join([f'title = "{title}"', *text[1:]]))

    def verify(self, *arguments, order=2.0) -> subprocess.CompletedProcess:
        return subprocess.run(["/usr/bin/python3", "-B", ROOT / "validation/verify/verify.py", self.case, "--program",
                               HERE / "formula_solver.py", "--out", self.out, *arguments], capture_output=True, text=True,
                              env={**os.environ, "FORMULA_SOLVER_ORDER": str(order)}, timeout=60)

    def result(self) -> dict:
        return json.loads((self.out / "verification.json").read_text())

    def verdicts(self) -> dict:
        series = self.result()["series"]["one"]
        return {v["of"]: v["verdict"] for v in [*series["verdicts"], *series["checks"]["profile"]["verdicts"]]}

    def test_errors_order_and_verdicts_are_those_of_the_formula(self):
        answer = self.verify()
        self.assertEqual(answer.returncode, 1, answer.stderr)
        check = self.result()["series"]["one"]["checks"]["profile"]
        for spacing, size in (("100 mm", 0.1), ("50 mm", 0.05), ("25 mm", 0.025)):
            self.assertAlmostEqual(check["errors"][spacing], size**2, delta=1e-12)
        self.assertAlmostEqual(check["order"], 2.0, delta=1e-9)
        self.assertEqual(self.verdicts(), {"error at 50 mm": "pass", "error at 25 mm": "FAIL", "order": "pass",
                                           "processor time at 50 mm": "pass"})
        table = (self.out / "verdicts.txt").read_text()
        self.assertIn("not within the limits: 1 of 4 fail", table)

    def test_a_wrong_order_fails(self):
        self.verify(order=1.5)
        self.assertEqual(self.verdicts()["order"], "FAIL")

    def test_within_all_limits_is_exit_code_0(self):
        self.write(VERIFICATION.replace("0.0006", "0.0007"))
        self.assertEqual(self.verify().returncode, 0)

    def test_quick_runs_the_two_coarsest_and_judges_no_order(self):
        self.assertEqual(self.verify("--quick").returncode, 0)
        self.assertEqual(list(self.result()["series"]["one"]["runs"]), ["100 mm", "50 mm"])
        self.assertNotIn("order", self.verdicts())

    def test_what_is_answered_already_is_not_run_again(self):
        self.verify()
        again = self.verify()
        self.assertEqual(again.stderr.count("already there"), 3)
        self.assertEqual((self.out / "one" / "50mm" / "runs").read_text(), "x")
        self.retitle("another scene")
        self.verify()
        self.assertEqual((self.out / "one" / "50mm" / "runs").read_text(), "xx")

    def test_a_damaged_record_is_made_again(self):
        self.verify("--quick")
        before = self.result()
        for file in self.out.glob("*/*/manifest.json"):
            file.write_text("")
        answer = self.verify("--quick")
        self.assertNotIn("Traceback", answer.stderr)
        self.assertNotIn("already there", answer.stderr)
        self.assertEqual(self.result()["series"]["one"]["checks"], before["series"]["one"]["checks"])

    def test_a_refused_scene_is_told_and_not_judged(self):
        self.retitle("refused")
        answer = self.verify()
        self.assertEqual(answer.returncode, 6)
        self.assertIn("refused", answer.stderr)
        self.assertEqual(set(self.verdicts().values()), {"not judged"})

    def test_a_run_that_stopped_itself_shows_its_outcome_and_passes_no_time_limit(self):
        self.retitle("stops")
        self.assertEqual(self.verify().returncode, 1)
        self.assertIn("stopped: as asked", (self.out / "verdicts.txt").read_text())
        self.assertEqual(self.verdicts()["processor time at 50 mm"], "not judged")

    def test_wrong_cases_are_refused_with_their_place(self):
        for old, new, says in (('"50 mm", "25 mm"]', '"50 mm"]', "at least three spacings"),
                               ('"100 mm", "50 mm", "25 mm"', '"25 mm", "50 mm", "100 mm"', "from coarse to fine"),
                               ('kind = "profile"', 'kind = "profil"', "profil"),
                               ('at = "25 mm"', 'at = "20 mm"', "20 mm"),
                               (', because = "below (25 mm)^2: must fail"', "", "because"),
                               ('exact = "forced_channel"', 'exact = "force"', "force")):
            with self.subTest(new):
                self.write(VERIFICATION.replace(old, new, 1))
                answer = self.verify()
                self.assertEqual(answer.returncode, 2, answer.stderr)
                self.assertIn(says, answer.stderr)

    def test_accepting_keeps_the_result_without_its_curves_and_says_why(self):
        self.assertEqual(self.verify("--accept", "first").returncode, 1)
        kept = json.loads((self.case / "records" / "verification.json").read_text())
        self.assertEqual(kept["accepted_because"], "first")
        self.assertNotIn("curves", kept["series"]["one"]["checks"]["profile"])
        self.assertEqual(self.verify("--quick", "--accept", "part").returncode, 2)

    def test_the_picture_is_drawn(self):
        self.verify()
        drawn = subprocess.run(["/usr/bin/python3", "-B", ROOT / "reports/verification_figures.py", self.out],
                               capture_output=True, text=True, timeout=60)
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        self.assertGreater((self.out / "verification.png").stat().st_size, 20_000)


class NumericsStudyTest(unittest.TestCase):
    def test_the_table_says_what_made_it_and_its_picture_is_drawn(self):
        sys.path.insert(0, str(ROOT / "validation" / "verify"))
        import numerics_study
        run = {"commit": "abc", "clean": "yes", "processor": "formula", "threads": 1, "load_at_start": 0.5}
        rows = [{"choice": "recommended", "taylor_green_energy_error": "0.004", "taylor_green_velocity_error": "0.02",
                 "taylor_green_processor_seconds": "0.5", "cavity_u_error": "0.003", "cavity_processor_seconds": "7",
                 "start_up_couette_profile_error": "0.002", "start_up_couette_processor_seconds": "0.4"},
                {"choice": "shifting=none", "taylor_green_outcome": "stopped: void"}]
        text = numerics_study.table(rows, [run], {"taylor_green": "20 mm", "cavity": "20 mm",
                                                    "start_up_couette": "50 mm"})
        self.assertIn("commit abc, clean yes", text)
        with tempfile.TemporaryDirectory() as folder:
            file, picture = Path(folder) / "numerics.csv", Path(folder) / "numerics.png"
            file.write_text(text)
            drawn = subprocess.run(["/usr/bin/python3", "-B", ROOT / "reports/numerics_figure.py", file, picture],
                                   capture_output=True, text=True, timeout=60)
            self.assertEqual(drawn.returncode, 0, drawn.stderr)
            self.assertGreater(picture.stat().st_size, 10_000)


class HardMeasuresTest(unittest.TestCase):
    """A figure of a hard case, on a series made of numbers."""

    def record(self, spacing: str, count: list):
        row = np.array(list(zip(range(len(count)), count)), dtype=[("time", float), ("particles", float)])
        return types.SimpleNamespace(manifest={"scene_toml": f'[sph]\nspacing = "{spacing}"\n'}, series=lambda name: row)

    def test_a_range_over_the_start_is_that_of_the_run_itself(self):
        figure = tomllib.loads((ROOT / "validation/hard/books/hard.toml").read_text())["figure"]["count"]
        for spacing, columns, rows in (("3.75 mm", 240, 80), ("7.5 mm", 120, 40)):  # the channel of 0.9 by 0.3 m
            count = [columns * rows, (columns + 1) * rows, columns * rows]
            found = hard_measures.measure(self.record(spacing, count), figure)
            self.assertAlmostEqual(found.value, 1.0 / columns, delta=1e-12)

    def test_a_flap_that_bends_sweeps_the_area_between_its_places(self):
        # 10 x 40 mm, its particles 5 mm apart and in another order later; the tip moves 0.5 mm downstream, every place in
        # proportion to its height, and all of it slides 3 mm along itself, which sweeps nothing: 0.5 mm x 40 mm / 2.
        x, y = (each.ravel() for each in np.meshgrid(0.0125 + 0.005 * np.arange(2), 0.0025 + 0.005 * np.arange(8)))

        def snapshot(order, dx, dy):
            return types.SimpleNamespace(
                positions=np.column_stack([x + dx, y + dy, 0 * x])[order],
                fields={"role": np.full(16, hard_measures.SOLID), "identity": np.arange(16)[order]})

        start, later = np.arange(16), np.random.default_rng(1).permutation(16)
        scene = ('[sph]\nspacing = "5 mm"\n[solid.flap]\nbody = { from = ["10 mm", "0 mm"], to = ["20 mm", "40 mm"] }\n')
        record = types.SimpleNamespace(manifest={"scene_toml": scene}, snapshot_times=lambda: [0.0],
                                       snapshot=lambda time: snapshot(start, 0.0, 0.0))
        swept = hard_measures.sweeper(record)
        self.assertAlmostEqual(swept(snapshot(start, 0.0, 0.0)), 0.0, delta=1e-15)
        self.assertAlmostEqual(swept(snapshot(later, 0.5e-3 * y / 0.04, 3e-3)), 1e-5, delta=1e-12)

    def test_what_starts_at_nothing_is_no_scale(self):
        figure = {"kind": "series", "series": "s", "column": "particles", "take": "range", "scale": "start"}
        with self.assertRaises(hard_measures.Missing):
            hard_measures.measure(self.record("5 mm", [0, 4]), figure)


class SlopeTest(unittest.TestCase):
    def test_slope(self):
        from verify import slope
        self.assertAlmostEqual(slope([0.4, 0.2, 0.1], [3 * s**1.7 for s in (0.4, 0.2, 0.1)]), 1.7)
        self.assertIsNone(slope([0.1], [0.2]))
        self.assertIsNone(slope([0.1, 0.2], [0.0, 0.2]))
        self.assertTrue(math.isfinite(slope([0.1, 0.2], [1.0, 1.0])))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
