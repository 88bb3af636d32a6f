#!/usr/bin/env python3
"""stability_study.py [SCENE] --program sprung-sph --out DIR [--quick] [--accept]: maps of the largest stable time step.

Bisects sph.time_step for three integrators over stiffness, viscosity and spacing of SCENE (else validation/hard/map.toml;
it names one body), one varied at a time. A step is stable if the run takes STEPS steps and is not stopped by its guard.
Leaves DIR/stability.csv: the automatic step, the measured limit as a bracket, what theory says. What the same program
has answered already is not run again. --accept keeps the table as validation/hard/records/stability.csv.

Theory (sph/METHOD.md, sph/effects): printed 2 mu/C44; symplectic 0.7071 dx sqrt(rho/k_e); viscous, every integrator,
1/(2 nu V sum |F|), the bound of Adams-Bashforth; implicit springs have no limit of their own.
"""

import argparse
import math
import sys
import time
from pathlib import Path

from scene import Scene
from verify import ROOT, WRONG_USE, Runner, facts, keep_file, say, say_point, study_parser, write_whole

from record import Record, quantity  # noqa: I001  (scene.py made the reader known)

STEPS = {"printed": 3000, "symplectic": 600, "recommended": 600}
# C44 = k_e along the axes for bonds of equal stiffness; lambda = E / k_e = 1.5 in the plane.
LAMBDA = 1.5
# The springs of the paper, in the fluid of `recommended`: a fluid that tears by itself would hide their limit.
EXPLICIT = ["numerics.spring_integration=explicit", "numerics.bonds=equal", "numerics.area_stiffness=0",
            "numerics.surface_correction=false"]
INTEGRATORS = {
    "printed": [*EXPLICIT, "numerics.position_update=mean_velocity"],
    "symplectic": EXPLICIT,
    "recommended": [],
}
FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0)
RATIO = 1.1  # a bracket is done when its ends are this close
LOWEST, HIGHEST = 1.0 / 8.0, 16.0  # times the automatic step


def kernel_rate(ratio: float) -> float:
    """2 V sum |F| dx^2 of the plane lattice for Wendland's kernel, h = ratio dx, its gradient normalised."""
    alpha, total, moment = 7.0 / (4.0 * math.pi * ratio**2), 0.0, 0.0
    for i in range(-4, 5):
        for j in range(-4, 5):
            r = math.hypot(i, j)
            if 0.0 < r < 2.0 * ratio:
                factor = 5.0 * alpha / ratio**2 * (1.0 - 0.5 * r / ratio) ** 3
                total, moment = total + factor, moment + factor * i * i
    return 2.0 * total / moment


class Point:
    """One place on the map: an integrator and the overrides that make it."""

    def __init__(self, study, integrator: str, varied: str, value: float, overrides: list):
        self.study, self.integrator, self.varied, self.value = study, integrator, varied, value
        self.overrides = [*INTEGRATORS[integrator], *overrides]
        self.name = f"{integrator}/{varied}_{value:.4g}"
        self.facts = None

    def run(self, name: str, overrides: list) -> Record:
        folder = self.study.out / "runs" / self.name / name
        fault = self.study.runner.run(f"{self.name} {name}", self.study.scene, [*self.overrides, *overrides], folder)
        if fault:
            raise RuntimeError(f"{self.name} {name}: {fault}")
        record = Record(folder, name)
        self.facts = facts(record, folder)
        return record

    def stable(self, step: float) -> bool:
        steps = STEPS[self.integrator]
        record = self.run(f"{step:.6g}", [f'sph.time_step="{step:.9g} s"', f'time.end="{steps * step:.9g} s"'])
        return record.finished

    def measure(self) -> dict:
        start = self.run("automatic", ['time.end="1e-9 s"'])
        scene, automatic = Scene.of_toml(start.manifest["scene_toml"]), start.manifest["numbers"]["time_step"]
        low, high, factor = None, None, 1.25
        # Outwards from 1.25 times the automatic step, which must hold if that is to be 0.8 of the limit.
        if self.stable(factor * automatic):
            low = factor * automatic
            while high is None and low < HIGHEST * automatic:
                if self.stable(1.5 * low):
                    low *= 1.5
                else:
                    high = 1.5 * low
        else:
            high = factor * automatic
            while low is None and high > LOWEST * automatic:
                if self.stable(high / 1.5):
                    low = high / 1.5
                else:
                    high /= 1.5
        while low and high and high > RATIO * low:
            middle = math.sqrt(low * high)
            low, high = (middle, high) if self.stable(middle) else (low, middle)
        return {"integrator": self.integrator, "varied": self.varied, "value": self.value, "automatic": automatic,
                "set_by": start.manifest.get("time_step_limit", ""), "stable": low, "unstable": high,
                "theory": self.theory(scene)}

    def theory(self, scene: Scene) -> float | None:
        solid = next(iter(scene.entry("solid").values()))
        k_e = quantity(solid["youngs_modulus"]) / LAMBDA
        viscous = scene.spacing**2 / scene.kinematic_viscosity / kernel_rate(scene.number("numerics.smoothing_length_ratio"))
        springs = {"printed": 2.0 * scene.number("viscosity.dynamic") / k_e,
                   "symplectic": math.sqrt(0.5) * scene.spacing * math.sqrt(scene.number("fluid.density") / k_e),
                   "recommended": math.inf}[self.integrator]
        return min(springs, viscous)


class Study:
    def __init__(self, options: argparse.Namespace):
        self.out, self.scene = options.out, options.scene
        self.runner = Runner(options.program, 1, options.time_limit)
        raw = Scene.of_toml(options.scene.read_text())
        bodies = list(raw.table.get("solid", {}))
        if len(bodies) != 1:
            raise ValueError(f"{options.scene}: the map is for a scene of one body, not of {len(bodies)}")
        modulus = f"solid.{bodies[0]}.youngs_modulus"
        self.axes = {"stiffness": (modulus, raw.number(modulus), "Pa"),
                     "viscosity": ("viscosity.dynamic", raw.number("viscosity.dynamic"), "Pa s"),
                     "spacing": ("sph.spacing", raw.spacing, "m")}

    def points(self, quick: bool):
        for integrator in INTEGRATORS:
            for varied, (key, middle, unit) in self.axes.items():
                factors = (0.5, 1.0) if varied == "spacing" else FACTORS
                for factor in factors[::2] if quick else factors:
                    if factor == 1.0 and varied != "stiffness":
                        continue  # the middle is measured once
                    value = factor * middle
                    yield Point(self, integrator, varied, value, [f'{key}="{value:.9g} {unit}"'])


COLUMNS = ["integrator", "varied", "value", "automatic", "stable", "unstable", "theory", "automatic_over_stable",
           "unstable_over_theory"]


def table(rows: list, made: dict) -> str:
    lines = ["# Largest stable time step by bisection; made by ./sprung study stability.",
             "# stable and unstable: the bracket, s; empty: beyond what was tried (1/8 to 16 times the automatic step).",
             f"# steps a run: {', '.join(f'{name} {n}' for name, n in STEPS.items())}; commit {made['commit']}, clean"
             f" {made['clean']}, {made['processor']}, {made['threads']} thread",
             ",".join(COLUMNS)]
    for row in rows:
        stable, unstable, theory = row["stable"], row["unstable"], row["theory"]
        more = {"automatic_over_stable": row["automatic"] / stable if stable else None,
                "unstable_over_theory": unstable / theory if unstable and math.isfinite(theory) else None}
        lines.append(",".join("" if v is None else v if isinstance(v, str) else f"{v:.4g}"
                              for v in ({**row, **more}[c] for c in COLUMNS)))
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = study_parser("stability")
    parser.add_argument("scene", nargs="?", type=Path, default=ROOT / "validation" / "hard" / "map.toml")
    options = parser.parse_args()
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        options.scene = options.scene.resolve(strict=True)
        study = Study(options)
    except (OSError, ValueError, KeyError) as fault:
        say(str(fault))
        return WRONG_USE
    points, rows, began = list(study.points(options.quick)), [], time.monotonic()
    for position, point in enumerate(points):
        say_point("point", position, len(points), point.name, began)
        try:
            rows.append(point.measure())
        except RuntimeError as fault:
            say(str(fault))
            continue
        write_whole(options.out / "stability.csv", table(rows, point.facts))
    if not rows:
        say("no point was measured")
        return 6
    print((options.out / "stability.csv").read_text(), end="")
    if options.accept:
        keep_file(options.out / "stability.csv", ROOT / "validation" / "hard" / "records")
    return 0 if all(row["stable"] and row["automatic"] <= 0.8 * row["stable"] * 1.0001 for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
