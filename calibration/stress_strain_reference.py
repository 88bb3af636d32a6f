#!/usr/bin/python3
"""The cube tests of stress_strain.csv once more, by the finite element reference: the third column beside springs and
closed form.

    calibration/stress_strain_reference.py --tables results/calibration
    calibration/stress_strain_reference.py --tables calibration --program build/release/bin/sprung-reference-solid

sprung-reference-solid stretches an incompressible neo-Hookean cube of side 0.1 m in space by stresses on its faces, in
increments to 31 %; its nominal stress at the table's stretches is the polynomial through the six nearest increments
(1e-6 of G off at most, judged by four). Simple shear is prescribed. Pure shear in space needs a face held at its place,
which the program does not offer. Adds reference_over_g, springs_over_reference and reference_over_closed_form and
writes stress_strain_reference.csv with its manifest, which holds those of the reference's runs.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
G = 1.0e6  # Pa; cancels
INCREMENTS = 31
FURTHEST = {1: 1.31, -1: 0.69}  # stretch to reach, pulled and pushed


def closed_form(kind: str, s: float) -> float:
    """Nominal stress over G of the incompressible neo-Hookean cube."""
    return s - s ** (-2 if kind == "uniaxial" else -5)


def reference_run(program: Path, arguments: list, scratch: Path) -> tuple[list[dict], dict]:
    out = scratch / "cube.csv"
    # One cell: the deformation is homogeneous, and the elements hold it exactly.
    command = [str(program), "--youngs-modulus", f"{3 * G:g}", "--cells", "1", "1", "1",
               "--increments", str(INCREMENTS), *arguments]
    subprocess.run([*command, "--out", str(out)], check=True, stdout=subprocess.DEVNULL)
    with out.open(newline="") as stream:
        rows = [{key.split(" ")[0]: float(value) for key, value in row.items()} for row in csv.DictReader(stream)]
    manifest = json.loads(out.with_suffix(".json").read_text())
    kept = {key: manifest.get(key) for key in ("solver", "outcome", "version", "commit", "clean", "compiler",
                                               "compiler_flags", "processor_seconds", "libraries")}
    return rows, kept | {"command": " ".join(["sprung-reference-solid", *command[1:]])}


def through_nearest(x: np.ndarray, y: np.ndarray, at: float, points: int) -> float:
    nearest = np.argsort(np.abs(x - at))[:points]
    value = 0.0
    for i in nearest:
        others = nearest[nearest != i]
        value += y[i] * np.prod((at - x[others]) / (x[i] - x[others]))
    return float(value)


class Curve:
    """Stress over G against stretch, or shear, of the reference."""

    def __init__(self, program: Path, kind: str, runs: dict, scratch: Path):
        x, y = [0.0 if kind == "simple_shear" else 1.0], [0.0]
        for sign in (1, -1):
            if kind == "simple_shear":
                arguments = ["--shear", f"{sign * 0.31:g}"]
                column, stress = "shear", "shear_stress"
            else:
                load = f"{G * closed_form(kind, FURTHEST[sign]):.10g}"
                arguments = ["--stress", load, load if kind == "equibiaxial" else "0", "0"]
                column, stress = "stretch_x", "nominal_x"
            rows, runs[f"{kind}, {'pulled' if sign > 0 else 'pushed'}"] = reference_run(program, arguments, scratch)
            x += [sign * 0.31 * row["load"] if column == "shear" else row[column] for row in rows]
            y += [row[stress] / G for row in rows]
        self.x, self.y = np.array(x), np.array(y)

    def at(self, s: float) -> float:
        value = through_nearest(self.x, self.y, s, 6)
        if abs(value - through_nearest(self.x, self.y, s, 4)) > 1e-4:
            sys.exit(f"error: the reference's increments are too far apart at {s}")
        return value


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tables", type=Path, default=ROOT / "results/calibration", help="folder of stress_strain.csv")
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/bin/sprung-reference-solid")
    options = parser.parse_args()
    table = options.tables / "stress_strain.csv"
    if not table.is_file():
        sys.exit(f"error: {table}: no such table; `sprung calibrate stress-strain` writes it")
    if not options.program.is_file():
        sys.exit(f"error: {options.program}: no such program; build sprung-reference-solid")
    with table.open(newline="") as stream:
        rows = [row for row in csv.DictReader(stream) if row["dimension"] == "3"]
    runs, curves = {}, {}
    with tempfile.TemporaryDirectory() as scratch:
        for kind in ("uniaxial", "equibiaxial", "simple_shear"):
            curves[kind] = Curve(options.program, kind, runs, Path(scratch))
    result = []
    for row in rows:
        if row["deformation"] not in curves:
            continue
        s = float(row["stretch"])
        springs, solid = float(row["lattice_over_g"]), float(row["neo_hookean_over_g"])
        if abs(s - (0.0 if row["deformation"] == "simple_shear" else 1.0)) < 1e-9:
            continue
        reference = curves[row["deformation"]].at(s)
        result.append(row | {"reference_over_g": f"{reference:.6f}",
                             "springs_over_reference": f"{springs / reference:.4f}",
                             "reference_over_closed_form": f"{reference / solid:.6f}"})
    out = options.tables / "stress_strain_reference.csv"
    part = out.with_suffix(".part")
    with part.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(result[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(result)
    part.rename(out)
    out.with_suffix(".json").write_text(json.dumps(
        {"format": "sprung calibration 1", "table": out.name,
         "definition": "stress_strain.csv with the nominal stress over G of the finite element reference, an "
                       "incompressible neo-Hookean cube in space at finite strain, at the same stretch.",
         "springs": json.loads(table.with_suffix(".json").read_text())["run"], "reference": runs}, indent=2) + "\n")
    print(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
