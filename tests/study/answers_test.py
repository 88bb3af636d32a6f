#!/usr/bin/env python3
"""answers_test.py ROOT: the arithmetic of the studies on numbers made from formulas, and what they refuse."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "validation" / "study"))

import ablation  # noqa: E402
import block_point  # noqa: E402
import cost_table  # noqa: E402
import differences  # noqa: E402
import plan as plans  # noqa: E402
import quantities  # noqa: E402
import recommend  # noqa: E402
import regression  # noqa: E402


class Quantities(unittest.TestCase):
    def test_extrapolation_finds_the_limit_of_a_power(self):
        limit, slope = np.array([[3.0, -1.0]]), np.array([[0.4, 0.7]])
        for order in (1.0, 1.5, 2.0):
            levels = [limit + slope * h**order for h in (0.4, 0.2, 0.1)]
            found, trusted = quantities.extrapolated(*levels)
            self.assertAlmostEqual(trusted, order, delta=1e-9)
            self.assertLess(np.max(np.abs(found - limit)), 1e-12)

    def test_extrapolation_trusts_no_order_beyond_two_and_none_below_one(self):
        for order, trusted in ((3.0, 2.0), (0.5, 1.0)):
            levels = [np.array([[1.0 + h**order]]) for h in (0.4, 0.2, 0.1)]
            self.assertEqual(quantities.extrapolated(*levels)[1], trusted)

    def test_error_is_the_largest_of_the_rows(self):
        true = np.array([[3.0, 4.0], [0.0, 10.0]])
        found = true + [[0.3, 0.4], [0.0, 0.5]]
        self.assertAlmostEqual(quantities.error({"kind": "displacement"}, found, true), 0.1)  # 0.5 of 5; 0.5 of 10
        scaled = {"kind": "profile", "scale": "2 m/s"}
        self.assertAlmostEqual(quantities.error(scaled, found, true), 0.25)  # largest 0.5 of 2
        self.assertAlmostEqual(quantities.error({**scaled, "norm": "rms"}, found, true), 0.5 / 2.0 / 2.0**0.5)

    def test_a_run_of_other_numbers_is_no_match(self):
        with self.assertRaises(quantities.Missing):
            quantities.error({"kind": "energy"}, np.zeros((3, 1)), np.ones((4, 1)))


class Plans(unittest.TestCase):
    def test_every_case_with_a_study_is_whole(self):
        cases = sorted(file.parent for file in (ROOT / "validation").glob("*/cost.toml"))
        self.assertGreaterEqual(len(cases), 3)
        for case in cases:
            for quick in (False, True):
                with self.subTest(case.name, quick=quick):
                    plan = plans.read(case, quick)
                    self.assertEqual({point.solver for point in plan.points}, {"particles", "reference"})
                    for solver in plans.SOLVERS:
                        self.assertTrue(plan.scene(solver).exists())

    def test_a_slip_is_refused_in_words(self):
        good = (ROOT / "validation" / "cavity" / "cost.toml").read_text()
        for slip, by, says in (('kind = "mean_profile"', 'kind = "mean_profil"', "mean_profil"),
                               ('solver = "particles"', 'solver = "sph"', "'sph'"),
                               ("[truth]", "[trutj]", "[truth] has one of"),
                               ("quick = [0, 2]", "quick = [0, 9]", "point 9"),
                               ("limit = 0", "limit = 7", "limit names point 7"),
                               ("limit = 0", 'twin = "mesh"', "twin names no point: mesh"),
                               ("repeats = [3, 3,", "repeats = [3,", "repeats has 6 numbers for 7 points"),
                               ("repeats = 3", "repeats = ", "cost.toml")):
            with tempfile.TemporaryDirectory() as folder, self.subTest(by):
                self.assertIn(slip, good)
                (Path(folder) / "cost.toml").write_text(good.replace(slip, by, 1))
                with self.assertRaises(plans.WrongPlan) as refused:
                    plans.read(Path(folder))
                self.assertIn(says, str(refused.exception))


    def test_points_have_repeats_of_their_own(self):
        plan = plans.read(ROOT / "validation" / "beam_in_channel")
        self.assertEqual([plan.point(f"spacing.{k}").repeats for k in range(6)], [3, 3, 3, 3, 2, 1])
        self.assertEqual({point.repeats for point in plans.read(plan.case, True).points}, {1})


class Spans(unittest.TestCase):
    PLAN = plans.Plan(Path("case"), {"curve": {"spacing": {}, "step": {"limit": 0, "floor": "the spacing"}}})

    def test_five_points_over_a_decade_or_a_reason(self):
        rows = [{"curve": "spacing", "error": f"{0.2 / 2**k:g}"} for k in range(5)]  # 0.2 to 0.0125: a factor 16
        rows += [{"curve": "step", "error": "0.07", "error_own": own} for own in ("", "1e-4", "1e-3", "3e-3")]
        found = cost_table.spans_of(self.PLAN, rows)
        self.assertTrue(found["spacing"]["five_over_a_decade"])
        self.assertAlmostEqual(found["spacing"]["error"]["factor"], 16.0)
        self.assertFalse(found["step"]["five_over_a_decade"])  # four points, and three from the limit
        self.assertAlmostEqual(found["step"]["error_own"]["factor"], 30.0)
        self.assertIn("no decade: the spacing", cost_table.spans_text(found))
        self.assertFalse(cost_table.spans_of(self.PLAN, rows[1:])["spacing"]["five_over_a_decade"])

    def test_distance_from_the_limit_of_a_curve(self):
        plan = plans.Plan(Path("case"), {"quantity": {"tip": {"kind": "displacement"}}})
        limit = [{"numbers": {"tip": [[3.0, 4.0]]}}]
        self.assertEqual(cost_table.own_error(plan, [{"numbers": {"tip": [[3.3, 4.4]]}}], limit), "0.1")  # 0.5 of 5
        self.assertEqual(cost_table.own_error(plan, limit, limit), "")  # no point on a logarithmic axis
        self.assertEqual(cost_table.own_error(plan, [{"numbers": {}}], limit), "")


class Blocks(unittest.TestCase):
    def test_strain_of_a_neo_hookean_body(self):
        # sigma/E = (s - s^-2)/3 by hand: s = 1.3 gives 0.236095; s = 0.9 gives -0.111523
        self.assertAlmostEqual(quantities.strain_under_pull((1.3 - 1.3**-2) / 3.0), 0.3, delta=1e-12)
        self.assertAlmostEqual(quantities.strain_under_pull((0.9 - 0.9**-2) / 3.0), -0.1, delta=1e-12)
        self.assertAlmostEqual(quantities.strain_under_pull(1e-4), 1e-4 + 1e-8, delta=1e-11)  # e = x + x^2 + ...

    def test_unknowns_of_a_block(self):
        self.assertEqual(block_point.unknowns_of({"layers": "8"}, ()), 512)
        # One element of degree 2: 27 nodes of 3 displacements and 4 pressures; eight: 125 nodes and 32
        self.assertEqual(block_point.unknowns_of({}, ("--cells=1 1 1",)), 85)
        self.assertEqual(block_point.unknowns_of({}, ("--stress=1 0 0", "--cells=2 2 2")), 407)


def measured(solver: str, spacings_mm, error, time) -> list:
    """Points of a curve whose error and time are powers of the spacing in mm."""
    return [recommend.Measured("spacing", solver, f'sph.spacing="{h:g} mm"', error(h), time(h), 1.02)
            for h in spacings_mm]


ANY = [100.0]  # a channel so long that some spacing near any one divides it


class Recommendations(unittest.TestCase):
    # Error 1 % (h/4)^1.5, time 64 s (4/h)^3: by hand, 2 % wants h = 4 x 2^(2/3) = 6.35 mm, 16 s.
    TABLE = measured("particles", (8, 7, 5, 4), lambda h: 0.01 * (h / 4) ** 1.5, lambda h: 64.0 * (4.0 / h) ** 3)

    def test_a_power_law_is_met_between_the_points(self):
        found = recommend.for_error(self.TABLE, "particles", 0.02, 0.0, ANY)
        self.assertAlmostEqual(found.time, 16.0, delta=0.01)
        self.assertAlmostEqual(recommend.spacing_of(found.setting) * 1e3, 6.35, delta=0.01)
        self.assertAlmostEqual(found.error_factor, 1.0, delta=1e-6)  # every point is what its neighbours say

    def test_a_spacing_divides_the_channel(self):
        self.assertAlmostEqual(recommend.dividing(0.0044, [0.9, 0.3], True), 0.3 / 69)
        self.assertAlmostEqual(recommend.dividing(0.0044, [0.9, 0.3], False), 0.3 / 68)
        self.assertAlmostEqual(recommend.dividing(0.01, [2.2, 0.41], True), 0.01)
        self.assertIsNone(recommend.dividing(0.009, [2.2, 0.41], True))  # 5 mm is the next: no neighbour of 9 mm
        found = recommend.for_error(self.TABLE, "particles", 0.02, 0.0, [0.9, 0.3])
        self.assertAlmostEqual(recommend.spacing_of(found.setting), 0.3 / 48)  # 6.25 mm, the next finer than 6.35
        self.assertAlmostEqual(found.time, 64.0 * (4.0 / 6.25) ** 3, delta=1e-6)

    def test_a_channel_made_for_one_spacing_does_not_go_with_another(self):
        setting = 'sph.spacing="7 mm" domain.channel={ from = ["0 m", "0 m"], to = ["2.198 m", "0.41 m"] } numerics.courant=0.2'
        self.assertEqual(recommend.with_spacing(setting, 0.005), 'sph.spacing="5 mm" numerics.courant=0.2')

    def test_a_budget_is_kept_with_the_spread_of_the_repeats(self):
        found = recommend.for_time(self.TABLE, "particles", 16.1 * 1.02, 0.0, ANY)
        self.assertAlmostEqual(found.error, 0.02, delta=1e-4)
        self.assertLessEqual(found.time * found.time_factor, 16.1 * 1.02 * 1.0001)

    def test_uncertainty_is_what_a_point_left_out_shows(self):
        bumped = [recommend.Measured(**{**vars(one), "error": one.error * (1.2 if k == 1 else 1.0)})
                  for k, one in enumerate(self.TABLE)]
        found = recommend.for_error(bumped, "particles", 0.02, 0.0, ANY)
        self.assertGreaterEqual(found.error_factor, 1.2 * 0.999)
        self.assertLessEqual(found.error * found.error_factor, 0.02 * 1.0001)

    def test_what_nothing_reaches_is_not_promised(self):
        self.assertIsNone(recommend.for_error(self.TABLE, "particles", 0.001, 0.0, ANY))
        self.assertIsNone(recommend.for_error(self.TABLE, "particles", 0.0101, 0.01, ANY))  # the truth is no better
        self.assertIsNone(recommend.for_time(self.TABLE, "particles", 1.0, 0.0, ANY))

    def test_wrong_use_is_told(self):
        for text in ("3 parts", "-1%", "0"):
            with self.assertRaises(recommend.NoAnswer):
                recommend.parse_error(text)
        self.assertEqual(recommend.parse_error("3%"), 0.03)
        self.assertEqual(recommend.parse_time("5min"), 300.0)
        program = ROOT / "validation" / "study" / "recommend.py"
        with tempfile.TemporaryDirectory() as folder:
            answer = subprocess.run([sys.executable, "-B", program, folder, "--error", "3%"], capture_output=True,
                                    text=True)
        self.assertEqual(answer.returncode, 2)
        self.assertIn("cost_study.csv", answer.stderr)


class Checked(unittest.TestCase):
    """A table of errors 16, 8, 4, 2 % at 8, 4, 2, 1 mm for one case; another's measured at two of them."""

    def case(self, folder: Path, name: str, errors: dict) -> Path:
        case = folder / name
        (case / "records").mkdir(parents=True)
        points = ", ".join(f"['sph.spacing=\"{h} mm\"']" for h in errors)
        (case / "cost.toml").write_text(f"""title = "A case"
says = "an error"
[truth]
published = {{ drag = 1.0 }}
[quantity.drag]
says = "drag"
kind = "mean_value"
[curve.spacing]
says = "spacing"
solver = "particles"
fixed = {"[]" if name == "one" else "['fluid.density=2']"}
points = [{points}]
""")
        rows = "".join(f'spacing,{k},particles,"sph.spacing=""{h} mm""",{e:.6g},{8.0 / h**2:.6g},{8.0 / h**2:.6g},'
                       f"{8.0 / h**2:.6g},1\n" for k, (h, e) in enumerate(errors.items()))
        (case / "records" / "cost_study.csv").write_text(
            "curve,point,solver,setting,error,processor_seconds,processor_seconds_least,processor_seconds_most,repeats\n" + rows)
        (case / "records" / "cost_study.json").write_text('{"title": "A case", "truth_error": {"drag": 0.0}}')
        return case

    def test_a_setting_is_held_to_what_the_table_says_of_it(self):
        for off, within in ((1.15, True), (1.35, False), (0.7, False)):
            with tempfile.TemporaryDirectory() as folder, self.subTest(off):
                # The point at 2 mm is 1.2 times what its neighbours say, so the factor is 1.2.
                one = self.case(Path(folder), "one", {8: 0.16, 4: 0.08, 2: 0.048, 1: 0.02})
                other = self.case(Path(folder), "other", {8: 0.16 * off, 3: 0.5, 1: 0.02})
                self.assertEqual(recommend.check(one, other), within)

    def test_a_pair_at_equal_spacing(self):
        with tempfile.TemporaryDirectory() as folder:
            case = self.case(Path(folder), "one", {8: 0.16, 4: 0.08, 2: 0.04})
            self.assertEqual(recommend.at_equal_spacing(case), "")
            with (case / "cost.toml").open("a") as plan:
                plan.write('[curve.equal]\nsays = "nodes"\nsolver = "reference"\npoints = [["a"]]\ntwin = "spacing.1"\n')
            with (case / "records" / "cost_study.csv").open("a") as table:
                table.write("equal,0,reference,a,0.01,0.25,0.25,0.25,1\n")
            self.assertIn("the particles take 2 times as long", recommend.at_equal_spacing(case))  # 8/4^2 = 0.5 s

    def test_nothing_in_common_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            one = self.case(Path(folder), "one", {8: 0.16, 4: 0.08, 2: 0.04})
            with self.assertRaises(recommend.NoAnswer):
                recommend.check(one, self.case(Path(folder), "other", {7: 0.1, 3: 0.05}))


class Ablations(unittest.TestCase):
    def test_a_scene_without_a_table_keeps_all_else(self):
        scene = ROOT / "validation" / "beam_in_channel" / "scene.toml"
        with tempfile.TemporaryDirectory() as folder:
            study = ablation.Study(scene, [], Path(folder), None)
            text = study.scene_of(ablation.Variant("[viscosity]", [], "viscosity")).read_text()
            self.assertNotIn("[viscosity]", text)
            self.assertIn('profile = "parabolic"', text)  # a word, not the name of a file beside the scene
            text = study.scene_of(ablation.Variant("[solid.beam]", [], "solid.beam")).read_text()
            self.assertNotIn("[solid.beam]", text)
            self.assertNotIn("outline_of", text)  # nor the probes that look at it
            self.assertIn("velocity_along", text)


class Scaling(unittest.TestCase):
    def test_exponents_and_what_they_come_to_far_away(self):
        runs = [{"name": f"spacing.{k}", "repeat": 1, "outcome": "finished", "unknowns": n,
                 "processor_seconds": 1e-4 * n**1.5, "peak_memory_bytes": 5e7 + 600.0 * n,
                 "phases": {"solve": 5e-5 * n**1.5, "assembly": 5e-5 * n**1.5}} for k, n in enumerate((1000, 4000, 9000))]
        found = cost_table.scaling("spacing", runs)
        self.assertAlmostEqual(found["exponent"], 1.5, delta=1e-9)
        self.assertAlmostEqual(found["bytes_per_unknown"], 600.0, delta=1e-6)
        self.assertAlmostEqual(found["on_paper"]["1e+06"]["processor_seconds"], 1e5, delta=1e-2)
        self.assertAlmostEqual(found["phases"]["solve"]["share_of_finest"], 0.5)
        self.assertIsNone(cost_table.scaling("spacing", runs[:2]))  # two points always lie on a line
        short = [{**run, "processor_seconds": 1e-3 * run["processor_seconds"]} for run in runs]
        self.assertIsNone(cost_table.scaling("spacing", short))  # the start of a program says nothing


def answer(shift: float = 0.0, factor: float = 1.0, profile: float = 0.0) -> dict:
    """What differences.kept() gives of a swing of 1 Hz, late by `shift` s, and a profile raised by a part of itself."""
    t = np.linspace(0.0, 3.0, differences.SAMPLES)
    swing = factor * np.sin(2.0 * np.pi * (t - shift))
    return {"series": {"time": t.tolist(), "tip.displacement_x": swing.tolist()},
            "tables": {"profile.velocity_x": {"1": [1.0 + profile, 1.0 + profile]},
                       "profile.velocity_y": {"1": [0.0, 0.1]}}}


class Differences(unittest.TestCase):
    def of(self, **changes) -> dict:
        return {one.quantity: one for one in differences.differences(answer(), answer(**changes))}

    def test_nothing_differs_from_itself(self):
        for one in self.of().values():
            self.assertEqual(one.l2, 0.0)
        self.assertAlmostEqual(self.of()["tip.displacement_x"].amplitude, 1.0, delta=1e-12)

    def test_lag_and_amplitude_are_told_apart(self):
        found = self.of(shift=0.013, factor=1.1)["tip.displacement_x"]  # 1.3 samples late
        self.assertAlmostEqual(found.lag, 0.013, delta=1e-3)  # a tenth of a sample
        self.assertAlmostEqual(found.amplitude, 1.1, delta=2e-3)

    def test_a_small_component_is_measured_against_the_vector(self):
        found = self.of(profile=0.02)
        whole = np.sqrt(2.0 + 0.01)
        self.assertAlmostEqual(found["profile.velocity_x at 1 s"].l2, 0.02 * np.sqrt(2.0) / whole, delta=1e-12)
        self.assertEqual(found["profile.velocity_y at 1 s"].l2, 0.0)

    def test_limits_lie_between_noise_and_signal_or_say_that_they_cannot(self):
        limits = regression.limits_of(answer(), [answer(profile=0.001)], {"modulus": answer(profile=0.009)})
        row = limits["profile.velocity_x at 1 s"]
        self.assertFalse(row["blind"])
        self.assertAlmostEqual(row["limit"] / row["noise"], 3.0, delta=1e-9)  # sqrt(0.001 x 0.009)
        limits = regression.limits_of(answer(), [answer(profile=0.009)], {"modulus": answer(profile=0.001)})
        self.assertTrue(limits["profile.velocity_x at 1 s"]["blind"])
        row = limits["profile.velocity_x at 1 s"]
        self.assertEqual(row["limit"], regression.MARGIN * row["noise"])

    def test_verdicts_follow_the_limits_and_nothing_that_is_missing_passes(self):
        baseline = {**answer(), "limits": regression.limits_of(answer(), [answer(profile=0.001)],
                                                               {"modulus": answer(profile=0.009)})}
        def verdict(**changes):
            return {row["quantity"]: row["verdict"] for row in regression.verdicts(baseline, answer(**changes))[0]}
        self.assertEqual(verdict(profile=0.0025)["profile.velocity_x at 1 s"], "same")
        self.assertEqual(verdict(profile=0.0035)["profile.velocity_x at 1 s"], "CHANGED")
        less = answer()
        less["tables"].pop("profile.velocity_y")
        rows = {row["quantity"]: row["verdict"] for row in regression.verdicts(baseline, less)[0]}
        self.assertEqual(rows["profile.velocity_y at 1 s"], "CHANGED")


class Fronts(unittest.TestCase):
    def test_what_another_beats_in_both_is_left_out(self):
        rows = [{"solver": "particles", "error": e, "processor_seconds": t, "curve": "c", "setting": ""}
                for e, t in (("0.04", "1"), ("0.05", "2"), ("0.02", "3"), ("0.03", "4"), ("0.01", "9"))]
        self.assertEqual([row["processor_seconds"] for row in cost_table.front(rows, "particles")], ["1", "3", "9"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
