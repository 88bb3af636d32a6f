#!/usr/bin/env python3
"""stability_study.py [SCENE] --program sprung-sph --out DIR [--quick] [--accept]: maps of the largest stable time step.

Bisects sph.time_step for three integrators over stiffness, viscosity and spacing of SCENE (else validation/hard/map.toml;
it names one body), one varied at a time. A step is stable if the run takes STEPS steps and is not stopped by its guard.
Leaves DIR/stability.csv: the automatic step, the measured limit as a bracket, what theory says. What the same program
has answered already is not run again. --accept keeps the table as validation/hard/records/stability.csv.

The automatic step is the smallest that a run takes over as many steps. Theory: the step that advances plane waves of
the undisturbed lattice, below; it knows neither the body's surface nor its size, so it stands for a large body. An
unstable wave shows only once it has grown, so the theory's limit is where the fastest one grows by GROWTH in the run.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np
from scene import Scene, SceneMismatch
from verify import ROOT, WRONG_USE, Runner, facts, keep_file, say, say_point, study_parser, write_whole

from record import Record, quantity  # noqa: I001  (scene.py made the reader known)

STEPS = {"printed": 3000, "symplectic": 600, "recommended": 600}
LAMBDA = 1.5  # E / k_e of equal bonds in the plane
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


GROWTH = 12.0  # e-folds from the noise of a run to what its guard stops: a strain of 1e-6 to 0.2
WAVES = 16  # along each axis of a quarter of the Brillouin zone


class Lattice:
    """Plane waves on the square lattice of spacing 1: what viscosity, pressure and equal bonds do to each."""

    BONDS = np.array([(1, 0), (0, 1), (1, 1), (1, -1)], float)

    def __init__(self, ratio: float):
        places = np.array([(i, j) for i in range(-4, 5) for j in range(-4, 5) if 0 < math.hypot(i, j) < 2 * ratio], float)
        factor = (1.0 - 0.5 * np.hypot(*places.T) / ratio) ** 3  # Wendland's F; its scale by the normalised gradient
        factor /= (factor * places[:, 0] ** 2).sum()
        self.waves = []
        line = np.linspace(0.0, math.pi, WAVES + 1)
        for wave in [np.array((x, y)) for x in line for y in line if 0.0 < x and y <= x]:
            decay = 2.0 * (factor * (1.0 - np.cos(places @ wave))).sum()  # of viscosity, nu / dx^2
            gradient = (factor * np.sin(places @ wave)) @ places
            direction = self.BONDS / np.linalg.norm(self.BONDS, axis=1)[:, None]
            springs = (2.0 * (1.0 - np.cos(self.BONDS @ wave))[:, None] * direction).T @ direction  # k / m
            # The projection takes out what its Laplacian, the viscous sum, lets it.
            self.waves.append((decay, springs, np.eye(2) - np.outer(gradient, gradient) / decay))

    def growth(self, step: float, viscous: float, elastic: float, mean: bool) -> float:
        """Largest growth per step: x' = x + dt u' (or the mean of u and u'), u' = P (u - D - dt K x), D by
        Adams-Bashforth. `viscous` = nu/dx^2 (1/s), `elastic` = k/m (1/s^2)."""
        one, none, part = np.eye(2), np.zeros((2, 2)), 0.5 if mean else 1.0
        largest = 0.0
        for decay, springs, projection in self.waves:
            c = decay * viscous * step
            new = [projection @ m for m in (-elastic * step * springs, (1.0 - 1.5 * c) * one, 0.5 * c * one)]
            moved = [one + part * step * new[0], step * (part * new[1] + (1.0 - part) * one), part * step * new[2]]
            matrix = np.block([moved, new, [none, one, none]])
            largest = max(largest, np.abs(np.linalg.eigvals(matrix)).max())
        return math.log(largest)

    def limit(self, viscous: float, elastic: float, mean: bool, steps: int) -> float:
        """Largest step (s) whose fastest wave grows by less than GROWTH in `steps` steps."""
        low, high = 1e-9, 10.0
        while high > 1.01 * low:
            middle = math.sqrt(low * high)
            low, high = (low, middle) if self.growth(middle, viscous, elastic, mean) > GROWTH / steps else (middle, high)
        return low


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
        start = self.run("start", ['time.end="1e-9 s"'])
        scene, steps = Scene.of_toml(start.manifest["scene_toml"]), STEPS[self.integrator]
        first = start.manifest["numbers"]["time_step"]
        times = self.run("automatic", [f'time.end="{steps * first:.9g} s"']).series("force")["time"]
        automatic = min(first, np.diff(times).min())
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

    def theory(self, scene: Scene) -> float:
        """Of the undisturbed lattice. Implicit springs set no limit, so `recommended` is held by viscosity alone."""
        viscous = scene.kinematic_viscosity / scene.spacing**2
        if self.integrator == "recommended":
            elastic = 0.0
        else:
            solid = next(iter(scene.entry("solid").values()))
            elastic = quantity(solid["youngs_modulus"]) / LAMBDA / scene.number("fluid.density") / scene.spacing**2
        lattice = Lattice(scene.number("numerics.smoothing_length_ratio"))
        return lattice.limit(viscous, elastic, self.integrator == "printed", STEPS[self.integrator])


class Study:
    def __init__(self, options: argparse.Namespace):
        self.out, self.scene = options.out, options.scene
        self.runner = Runner(options.program, 1, options.time_limit)
        raw = Scene.of_toml(options.scene.read_text())
        bodies = list(raw.table.get("solid", {}))
        if len(bodies) != 1:
            raise ValueError(f"the map is for a scene of one body, not of {len(bodies)}")
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
    options.scene = options.scene.resolve()
    try:
        study = Study(options)
    except (OSError, ValueError, KeyError, SceneMismatch) as fault:
        say(f"no stability map of {options.scene}: {getattr(fault, 'strerror', None) or fault}; name a scene file")
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
