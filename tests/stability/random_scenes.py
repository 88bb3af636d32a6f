#!/usr/bin/env python3
"""random_scenes.py --program sprung-sph [--first N] [--count N] [--out DIR] [--keep FILE]: random scenes, whole programs.

Each scene is drawn from its number alone, within the ranges below, some with a slip on purpose. It must run its 100
steps, be refused (exit code 1, "error: ..."), or stop itself (exit code 3, "stopped: ..." with a time); no crash, no
hang, no number in its record that is none. The scene of one that does not is left in DIR. --keep writes the counts.

Ranges: spacing 0.1 mm to 0.1 m; box 6 to 20 spacings a side (6 to 9 in space); density 100 to 10,000 kg/m3; velocity
1 mm/s to 10 m/s; Reynolds number 0.1 to 10,000; Young's modulus 1 to 1e8 times rho u^2; steps 0.1 to 1 spacing / u.
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

STEPS = 100
# s of processor time, whatever else the machine does; a hundred steps of a few hundred particles take one. A run that is
# still going then has small steps of its own choice and is asked to pause; one that has not taken its steps, or does not
# pause, hangs.
PATIENCE = 30.0
WAITING = 1800.0  # s of wall time in which a run that needs none of the processor must end
AXES = "xyz"
SIDES = {"x": ("left", "right"), "y": ("bottom", "top"), "z": ("back", "front")}


class Draw:
    """One scene, drawn from its number."""

    def __init__(self, number: int):
        self.r = random.Random(number)
        self.plane = self.r.random() < 0.85
        self.dimension = 2 if self.plane else 3
        self.dx = self.power(-4, -1)
        self.count = [self.r.randint(6, 20 if self.plane else 9) for _ in range(self.dimension)]
        self.density, self.speed = self.power(2, 4), self.power(-3, 1)
        self.height = self.count[1] * self.dx
        self.viscosity = self.density * self.speed * self.height / self.power(-1, 4)
        self.step = self.dx / self.speed * self.power(-1, 0)
        self.preset = self.r.choice(["recommended", "recommended", "paper"])
        self.lines: list[str] = []
        self.bodies = 0

    def power(self, low: float, high: float) -> float:
        return 10.0 ** self.r.uniform(low, high)

    def lengths(self, values) -> str:
        return "[" + ", ".join(f'"{v:.17g} m"' for v in values) + "]"

    def vector(self, values, unit: str) -> str:
        return "[" + ", ".join(f'"{v:.9g} {unit}"' for v in values) + "]"

    def sides(self) -> None:
        """What each pair of sides is: through-flow, periodic, or walls."""
        no_slip, free_slip, periodic, moving = [], [], [], []
        flow = self.r.choice(["velocity", "pressures", "none", "outlet", "none"])
        for axis in AXES[:self.dimension]:
            low, high = SIDES[axis]
            if axis == "x" and flow != "none":
                if flow == "outlet":
                    no_slip.append(low)
                elif flow == "pressures":
                    self.lines += ["[inflow]", f'side = "{low}"', f'pressure = "{self.density * self.speed**2:.9g} Pa"',
                                   self.waveform()]
                else:
                    self.lines += ["[inflow]", f'side = "{low}"', f'profile = "{self.r.choice(["parabolic", "uniform"])}"',
                                   f'mean_velocity = "{self.speed / 1.5:.9g} m/s"',
                                   f'ramp = "{self.r.choice([0, 30]) * self.step:.9g} s"', self.waveform()]
                self.lines += ["[outflow]", f'side = "{high}"', 'pressure = "0 Pa"']
            elif self.r.random() < 0.25:
                periodic.append(axis)
            else:
                for side in (low, high):
                    (no_slip if self.r.random() < 0.75 else free_slip).append(side)
                    if side in no_slip and self.r.random() < 0.3:
                        moving.append((side, axis))
        if no_slip or free_slip:
            self.lines.append("[walls]")
            if no_slip:
                self.lines.append(f"no_slip = {json.dumps(no_slip)}")
            if free_slip:
                self.lines.append(f"free_slip = {json.dumps(free_slip)}")
        if periodic:
            self.lines += ["[periodic]", f"axes = {json.dumps(periodic)}"]
        for side, axis in moving:
            along = [0.0 if AXES[d] == axis else self.r.uniform(-1, 1) * self.speed for d in range(self.dimension)]
            self.lines += [f"[wall_motion.{side}]", f"velocity = {self.vector(along, 'm/s')}"]

    def waveform(self) -> str:
        period = self.step * self.r.choice([10, 50])
        wave = self.r.choice(["sin({0:.9g}*t)", "0.5 + 0.5*sin({0:.9g}*t)", "", ""]).format(2 * math.pi / period)
        return f'waveform = {{ formula = "{wave}" }}' if wave else ""

    def forces(self) -> None:
        if self.r.random() < 0.3:
            g = self.speed**2 / self.height
            self.lines += ["[gravity]",
                           f"acceleration = {self.vector([self.r.uniform(-1, 1) * g for _ in range(self.dimension)], 'm/s2')}"]
        if self.r.random() < 0.35:
            k = 2 * math.pi / self.height
            waves = [f"{self.speed:.9g}*sin({k:.9g}*{self.r.choice(AXES[:self.dimension])})" for _ in range(self.dimension)]
            self.lines += ["[initial]", f"velocity = {json.dumps(waves)}"]

    def solids(self) -> None:
        for number in range(self.r.choice([0, 0, 1, 1, 2])):
            thinnest = self.r.choice([1, 2, 2, 2, 3])
            cells = [self.r.randint(thinnest, 5) for _ in range(self.dimension)]
            clamped = self.r.random() < 0.7
            start = [0 if clamped and d == 1 else self.r.randint(0, max(0, self.count[d] - cells[d]))
                     for d in range(self.dimension)]
            jitter = self.r.choice([0.0, 0.0, 0.3])
            low = [s * self.dx for s in start]
            high = [(s + c + jitter) * self.dx for s, c in zip(start, cells)]
            angle = f", angle_degrees = {self.r.uniform(-90, 90):.6g}" if self.r.random() < 0.15 else ""
            modulus = self.density * self.speed**2 * self.power(0, 8)
            self.lines += [f"[solid.body_{number}]", f"body = {{ from = {self.lengths(low)}, to = {self.lengths(high)}{angle} }}",
                           f'youngs_modulus = "{modulus:.9g} Pa"'] + (['clamped = "bottom"'] if clamped else [])
            if self.r.random() < 0.1:
                self.lines += [f"[solid.body_{number}.stiffening]", f"ratio = {self.power(0, 2):.6g}", "toe_strain = 0.1"]
            if self.r.random() < 0.1:
                self.lines += [f"[solid.body_{number}.viscoelastic]", f'modulus = "{modulus * self.power(-1, 1):.9g} Pa"',
                               f'relaxation_time = "{self.step * self.power(-1, 3):.9g} s"']
            self.bodies += 1

    def curved(self) -> None:
        if not self.plane or self.bodies or self.r.random() > 0.12:
            return
        centre = [0.5 * c * self.dx for c in self.count[:2]]
        radius = self.r.uniform(1, 8) * self.dx
        self.lines += ["[curved_wall.post]", f'circle = {{ centre = {self.lengths(centre)}, radius = "{radius:.9g} m" }}',
                       f'fluid = "{self.r.choice(["outside", "outside", "inside"])}"']

    def numerics(self) -> None:
        self.lines += ["[numerics]", f'preset = "{self.preset}"']
        for key, values in {"smoothing_length_ratio": [1.0, 1.3, 1.5, 2.0], "gradient_correction": [True, False],
                            "shifting": ["none", "xu", "fickian"], "density_feedback": [0, 0.5, 5],
                            "volume_along_step": [True, False], "void_feedback": [0, 2, 10],
                            "fitted_bodies": [True, False], "body_projections": [1, 2, 5],
                            "pressure_tolerance": [1e-1, 1e-6, 1e-10], "spring_integration": ["explicit", "implicit"],
                            "pressure_solver": ["bicgstab", "jacobi_cg", "cholmod", "incomplete_cholesky", "boomeramg"],
                            "solid_no_slip": ["centres", "face"], "position_update": ["mean_velocity", "new_velocity"],
                            "courant": [0.05, 1.5]}.items():
            if self.r.random() < 0.15:
                self.lines.append(f"{key} = {json.dumps(self.r.choice(values))}")
        self.lines += ["[sph]", f'spacing = "{self.dx:.17g} m"', f'velocity_scale = "{2 * self.speed:.9g} m/s"']
        if self.r.random() < 0.95:
            self.lines.append(f'time_step = "{self.step:.9g} s"')
        if self.r.random() < 0.5:
            self.lines += [f"disorder = {self.r.choice([0.01, 0.1, 0.3])}", f"seed = {self.r.randint(1, 1000)}"]
        if self.r.random() < 0.2:
            self.lines.append("retreat = true")

    def slip(self, text: str) -> str:
        """One scene in ten has a mistake that a user could make."""
        if self.r.random() > 0.1:
            return text
        return self.r.choice([
            lambda: text.replace("density = \"", "density = \"-", 1),
            lambda: text.replace(" m\"", " s\"", 1),
            lambda: text.replace("[fluid]", "[fliud]", 1),
            lambda: text.replace("spacing = \"", "spacing = \"1e3", 1),
            lambda: text.replace("Pa s", "Pa", 1),
            lambda: text.replace("side = \"right\"", "side = \"left\"", 1),
            lambda: text[: self.r.randint(1, len(text))],
        ])()

    def text(self) -> str:
        size = [c * self.dx for c in self.count]
        self.lines += ['title = "A random scene"', 'source = "tests/stability/random_scenes.py"', "[domain]",
                       f"channel = {{ from = {self.lengths([0.0] * self.dimension)}, to = {self.lengths(size)} }}",
                       "[time]", f'end = "{STEPS * self.step:.9g} s"', "[fluid]", f'density = "{self.density:.9g} kg/m3"']
        if self.r.random() < 0.9:
            self.lines += ["[viscosity]", f'dynamic = "{self.viscosity:.9g} Pa s"']
        self.sides()
        self.forces()
        self.solids()
        self.curved()
        self.lines += ["[record]", f'fields_every = "{0.5 * STEPS * self.step:.9g} s"']
        self.numerics()
        return self.slip("\n".join(line for line in self.lines if line) + "\n")


def faults_of_record(out: Path, finished: bool) -> str:
    """"" if the record is whole and every number in it is one."""
    if not (out / "manifest.json").exists():
        return "no manifest"
    outcome = json.loads((out / "manifest.json").read_text())["outcome"]
    if finished != (outcome == "finished"):
        return f"outcome in the manifest: {outcome}"
    for file in sorted((out / "probes").glob("*.csv")):
        for line in file.read_text().splitlines()[1:]:
            if not all(math.isfinite(float(cell)) for cell in line.split(",")):
                return f"{file.name} holds {line}"
    return ""


def processor_seconds(process: int) -> float:
    """What a process has used so far, all its threads (proc(5), fields 14 and 15)."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def judge(number: int, program: Path, folder: Path) -> tuple[str, str]:
    """(how it ended, what is wrong with that or "")."""
    scene, out = folder / "scene.toml", folder / "out"
    scene.write_text(Draw(number).text())
    child = subprocess.Popen([program, "run", scene, "--out", out], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                             text=True)
    paused, began, said = False, time.monotonic(), None
    while said is None:
        try:
            _, said = child.communicate(timeout=1.0)
        except subprocess.TimeoutExpired:
            spent = processor_seconds(child.pid)
            if spent > PATIENCE and not paused:
                child.terminate()
                paused = True
            elif spent > 2 * PATIENCE or time.monotonic() - began > WAITING:
                child.kill()
                child.communicate()
                return "hung", f"still running after {spent:g} s of the processor, asked to pause: {paused}"
    if child.returncode == 0 and paused:
        steps = json.loads((out / "manifest.json").read_text())["numbers"]["steps"]
        return ("ran", "") if steps >= STEPS else ("hung", f"{steps:g} steps in {PATIENCE:g} s of the processor")
    if child.returncode == 0:
        return "ran", faults_of_record(out, True)
    if child.returncode == 1:
        good = said.lstrip().startswith("error: ") or "\nerror: " in said
        left = "a record beside the refusal" if (out / "manifest.json").exists() else ""
        return "refused", left if good else f"exit code 1 without a message: {said[-300:]}"
    if child.returncode == 3:
        good = "stopped: " in said and "at t = " in said
        return "stopped", faults_of_record(out, False) if good else f"no message of what and when: {said[-300:]}"
    return "crashed", f"exit code {child.returncode}: {said[-300:]}"


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--out", type=Path, help="where scenes that misbehave are left")
    parser.add_argument("--keep", type=Path, help="a JSON file for the counts")
    options = parser.parse_args()
    counts, wrong, began = Counter(), {}, time.monotonic()
    for position, number in enumerate(range(options.first, options.first + options.count)):
        with tempfile.TemporaryDirectory() as folder:
            end, fault = judge(number, options.program.resolve(), Path(folder))
        counts[end] += 1
        if fault:
            wrong[number] = f"{end}: {fault}"
            print(f"scene {number}: {wrong[number]}", flush=True)
            if options.out:
                options.out.mkdir(parents=True, exist_ok=True)
                (options.out / f"scene_{number}.toml").write_text(Draw(number).text())
        if (position + 1) % 50 == 0:
            left = (time.monotonic() - began) / (position + 1) * (options.count - position - 1)
            print(f"{position + 1} of {options.count}, about {left:.0f} s left: {dict(counts)}", file=sys.stderr, flush=True)
    print(f"{options.count} scenes from {options.first}: " + ", ".join(f"{n} {end}" for end, n in sorted(counts.items()))
          + f"; {len(wrong)} misbehaved")
    if options.keep:
        options.keep.write_text(json.dumps({"first": options.first, "count": options.count, "ends": counts,
                                            "misbehaved": wrong}, indent=1) + "\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
