#!/usr/bin/env python3
"""ablation.py SCENE [table.key=value ...] --program PROGRAM --out DIR [--time-limit SECONDS] [--accept REASON]

Switches off each effect that the scene calls for and each numerical choice, one at a time, and measures what the
result loses and what the run saves. Loss: the largest relative L2 difference from the whole run, over every quantity
that the record holds (differences.py), and, where the scene's case has a kept cost study, the error against its truth.
The first row is a run that differs in nothing but its start: no loss below it means anything.

Leaves DIR/ablation.csv and DIR/ablation.json, what made it. What the same program has answered already is not run
again. --accept keeps both in the folder `records` beside the scene.
"""

import argparse
import csv
import io
import json
import re
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import quantities

from differences import differences, kept  # noqa: I001  (quantities.py made the reader known)
from verify import Runner, facts, say, write_whole
from record import Record

WRONG_USE, NO_RUN = 2, 6
# Every numerical choice and what it is like without it; the second: only of scenes with a body.
CHOICES = [
    ("smoothing_length_ratio", "1.0", False),
    ("normalised_gradient", "false", False),
    ("gradient_correction", "false", False),
    ("shifting", "none", False),
    ("volume_along_step", "false", False),
    ("density_feedback", "0", False),
    ("void_feedback", "0", False),
    ("pressure_tolerance", "0.1", False),
    ("pressure_solver", "jacobi_cg", False),
    ("position_update", "mean_velocity", False),
    ("courant", "0.8", False),
    ("body_projections", "1", True),
    ("fitted_bodies", "false", True),
    ("bonds", "equal", True),
    ("solid_no_slip", "centres", True),
    ("surface_correction", "false", True),
    ("area_stiffness", "0", True),
    ("spring_integration", "explicit", True),
]
EFFECTS = ["viscosity", "viscosity.carreau_yasuda", "gravity", "wall_motion", "curved_wall", "inflow", "outflow",
           "periodic", "solid", "stiffening", "viscoelastic", "fibre"]
ANOTHER_START = "another start"


@dataclass
class Variant:
    what: str
    overrides: list
    without: str = ""  # name of the table that is left out of the scene


def word(value) -> str:
    return {True: "true", False: "false"}.get(value, str(value)) if isinstance(value, bool) else str(value)


def variants_of(scene: dict, file_text: str) -> list:
    """What can be switched off: choices that the resolved scene has and that are not off already; tables present."""
    disordered = scene.get("sph", {}).get("disorder", 0.0) > 0.0
    found = [Variant(ANOTHER_START, ["sph.seed=2"] if disordered else ["sph.disorder=0.1", "sph.seed=2"])]
    for name in tables_in(file_text):
        last = name.split(".")[-1]
        if name in EFFECTS or name.split(".")[0] in ("wall_motion", "curved_wall", "solid") or last in EFFECTS:
            found.append(Variant(f"[{name}]", [], name))
    for key, off, solids in CHOICES:
        now = scene.get("numerics", {}).get(key)
        if now is None or word(now) == off or (solids and "solid" not in scene) or same_number(now, off):
            continue
        found.append(Variant(f"{key} {word(now)} -> {off}", [f"numerics.{key}={off}"]))
    return found


def same_number(now, off: str) -> bool:
    try:
        return float(now) == float(off)
    except (TypeError, ValueError):
        return False


def tables_in(text: str) -> list:
    return re.findall(r"^\[([A-Za-z_.0-9]+)\]", text, re.MULTILINE)


def without_table(text: str, name: str) -> str:
    """The scene's text without a table, the tables within it, and the probes that look at it."""
    parts = re.split(r"(?m)^(?=\[[A-Za-z_.0-9]+\])", text)
    own = name.split(".")[-1]

    def stays(part: str) -> bool:
        head = re.match(r"\[([A-Za-z_.0-9]+)\]", part)
        if not head:
            return True
        if head[1] == name or head[1].startswith(name + "."):
            return False
        looks_at = re.search(rf'(force_on|outline_of)\s*=\s*"{re.escape(own)}"', part)
        moves = name.startswith("solid.") and "displacement_of" in part
        return not (head[1].startswith("probes.") and (looks_at or moves))

    return "".join(part for part in parts if stays(part))


@dataclass
class Study:
    scene: Path
    overrides: list
    out: Path
    runner: Runner

    def scene_of(self, variant: Variant) -> Path:
        if not variant.without:
            return self.scene
        file = self.out / "scenes" / f"without_{variant.without}.toml"
        file.parent.mkdir(exist_ok=True)
        text = without_table(self.scene.read_text(), variant.without)
        # Files that the scene names lie beside it.
        text = re.sub(r'(\bfile\s*=\s*)"([^"/][^"]*)"', lambda m: f'{m[1]}"{self.scene.parent / m[2]}"', text)
        if not file.exists() or file.read_text() != text:
            file.write_text(text)
        return file

    def refusal(self, variant: Variant) -> str:
        """Why the scene cannot do without; "" if it can."""
        answer = subprocess.run([self.runner.program, "check", self.scene_of(variant), *self.overrides_of(variant)],
                                capture_output=True, text=True)
        if answer.returncode == 0:
            return ""
        last = answer.stderr.strip().splitlines()[-1].removeprefix("error: ")
        return re.sub(r"(?<![\w.])/[^\s:\"]*/", "", last)  # a kept table says nothing of this machine's folders

    def overrides_of(self, variant: Variant) -> list:
        kept_ones = [one for one in self.overrides if not variant.without or not one.startswith(variant.without)]
        if variant.without:  # overrides of probes that went with the table
            there = tables_in(self.scene_of(variant).read_text())
            kept_ones = [one for one in kept_ones
                         if not one.startswith("probes.") or ".".join(one.split("=")[0].split(".")[:2]) in there]
        return [*kept_ones, *variant.overrides]

    def run(self, name: str, variant: Variant) -> tuple[str, Record | None]:
        folder = self.out / "runs" / re.sub(r"[^A-Za-z0-9_.]+", "_", name).strip("_")
        fault = self.runner.run(f"ablation, {name}", self.scene_of(variant), self.overrides_of(variant), folder)
        if (folder / "manifest.json").exists() and "refused" not in fault:
            return fault, Record(folder, name)
        return fault or "no record", None


def loss_of(whole: dict, record: Record) -> tuple[float, str, dict]:
    """Largest difference, its quantity, and the largest of each probe."""
    by_probe, largest, where = {}, 0.0, ""
    for one in differences(whole, kept(record)):
        probe = one.quantity.split(".")[0]
        if probe.startswith("ledger") and probe != "ledger_energy":
            continue
        by_probe[probe] = max(by_probe.get(probe, 0.0), one.l2)
        if one.l2 > largest:
            largest, where = one.l2, one.quantity
    return largest, where, by_probe


def truth_beside(scene: Path) -> tuple[dict, dict]:
    """(quantities, true numbers) of the kept cost study of the scene's case; both empty where there is none."""
    file = scene.parent / "records" / "cost_study.json"
    if not file.exists() or scene.name != "scene.toml":
        return {}, {}
    about = json.loads(file.read_text())
    return about["quantities"], {name: np.array(values) for name, values in about.get("true", {}).items()}


def error_of(record: Record, wanted: dict, true: dict) -> str:
    try:
        errors = [quantities.error(one, quantities.take(record, one), true[name]) for name, one in wanted.items()]
        return f"{max(errors):.4g}" if errors else ""
    except quantities.Missing:
        return ""


def row_of(variant: str, fault: str, record: Record | None, base: Record, whole: dict, truth: tuple) -> dict:
    row = {"switched_off": variant, "outcome": fault or "no record"}
    if record is None:
        return row
    manifest, asked = record.manifest, base.manifest
    row["outcome"] = (fault or manifest["outcome"]).replace(",", ";")
    reached = record.series("ledger_energy")
    row["reached_s"] = f"{reached['time'][-1]:.4g}" if reached is not None else ""
    row |= {"processor_seconds": f"{manifest['processor_seconds']:.4g}", "steps": int(manifest["numbers"].get("steps", 0))}
    if not record.finished:
        return row
    largest, where, by_probe = loss_of(whole, record)
    row |= {"loss": f"{largest:.4g}", "largest_in": where, "error": error_of(record, *truth),
            "time_ratio": f"{manifest['processor_seconds'] / asked['processor_seconds']:.3f}"}
    return row | {f"loss_{probe}": f"{value:.4g}" for probe, value in by_probe.items()}


def as_csv(rows: list, scene: Path, overrides: list) -> str:
    names = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    text.write(f"# What each effect and choice of {scene.parent.name}/{scene.name} {' '.join(overrides)} is worth: loss is the"
               " largest relative L2 difference from the whole run; made by ./sprung study ablation, what made it stands"
               " in the JSON file beside it.\n")
    writer = csv.DictWriter(text, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def study(options: argparse.Namespace) -> int:
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    runner = Runner(options.program.resolve(), 1, options.time_limit)
    scene = options.scene.resolve()
    here = Study(scene, options.overrides, out, runner)
    fault, base = here.run("whole", Variant("nothing", []))
    if base is None or not base.finished:
        say(f"the whole scene did not run: {fault or base.manifest['outcome']}")
        return NO_RUN
    whole, truth = kept(base), truth_beside(scene)
    rows = [{**row_of("nothing", "", base, base, whole, truth), "loss": "0"}]
    made, variants = [facts(base, base.folder)], variants_of(tomllib.loads(base.manifest["scene_toml"]), scene.read_text())
    for number, variant in enumerate(variants, 1):
        say(f"{number} of {len(variants)}: {variant.what}")
        refusal = here.refusal(variant)
        if refusal:
            rows.append({"switched_off": variant.what, "outcome": "cannot be switched off: " + refusal.replace(",", ";")})
            continue
        fault, record = here.run(variant.what, variant)
        rows.append(row_of(variant.what, fault, record, base, whole, truth))
        if record is not None:
            made.append(facts(record, record.folder))
        write_whole(out / "ablation.csv", as_csv(rows, scene, options.overrides))
    about = {"format": "sprung ablation 1", "accepted_because": options.accept or "",
             "scene": f"{scene.parent.name}/{scene.name}", "overrides": options.overrides,
             **{key: sorted({str(run[key]) for run in made}) for key in ("commit", "clean", "processor", "threads")},
             "load_at_start": sorted(run["load_at_start"] for run in made if run["load_at_start"] is not None)}
    write_whole(out / "ablation.json", json.dumps(about, indent=1) + "\n")
    if options.accept:
        if about["clean"] != ["yes"]:
            say("--accept keeps what a clean commit made; these runs were made with changes that are not committed")
            return WRONG_USE
        records = scene.parent / "records"
        records.mkdir(exist_ok=True)
        for name in ("ablation.csv", "ablation.json"):
            write_whole(records / name, (out / name).read_text())
    print((out / "ablation.csv").read_text(), end="")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(prog="./sprung study ablation", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("overrides", nargs="*")
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--time-limit", type=float)
    parser.add_argument("--accept", metavar="REASON")
    options = parser.parse_intermixed_args()
    if not options.scene.exists():
        say(f"there is no scene {options.scene}")
        return WRONG_USE
    return study(options)


if __name__ == "__main__":
    sys.exit(main())
