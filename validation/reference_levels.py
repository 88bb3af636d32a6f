#!/usr/bin/env python3
"""Runs the steady benchmarks of the finite element reference on three meshes each, every one with cells half as
large as those of the one before, and keeps what they found.

    validation/reference_levels.py --program build/release/bin/sprung-reference
    validation/reference_levels.py --program build/release/bin/sprung-reference cfd1 2d_1

Writes validation/<family>/records/levels.csv (case, degree, level, unknowns, processor seconds, quantity, value)
and levels.json: the manifests of the runs. Rows of cases that are not run stay.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
BASE = 33.4  # mm, cells of level 0
# case: family, degree, levels
CASES = {
    "cfd1": ("turek_hron", [2], [0, 1, 2]),
    "cfd2": ("turek_hron", [2], [0, 1, 2]),
    "csm1": ("turek_hron", [2], [0, 1, 2]),
    "csm2": ("turek_hron", [2], [0, 1, 2]),
    "fsi1": ("turek_hron", [2], [-1, 0, 1]),
    "2d_1": ("schaefer_turek", [2, 3], [0, 1, 2]),
}


def last(folder: Path, name: str) -> list[float]:
    file = folder / "probes" / f"{name}.csv"
    return [float(x) for x in file.read_text().split()[-1].split(",")] if file.is_file() else []


def quantities(folder: Path) -> dict[str, float]:
    found = {}
    tip, force = last(folder, "tip"), last(folder, "force")
    cylinder, flag = last(folder, "force_cylinder"), last(folder, "force_flag")
    if tip:
        found |= {"ux": tip[1], "uy": tip[2]}
    if cylinder and flag:
        found |= {"drag": cylinder[1] + flag[1], "lift": cylinder[2] + flag[2]}
    if force:  # coefficients 2 F/(rho u^2 D) = F/0.002
        found |= {"drag": force[1] / 0.002, "lift": force[2] / 0.002}
        pressure = last(folder, "pressure")
        found["pressure_difference"] = pressure[1] - pressure[2]
    return found


def run(program: str, case: str, degree: int, level: int, out: Path) -> dict:
    family = CASES[case][0]
    subprocess.run([program, HERE / family / f"{case}.toml", f"reference_fem.degree={degree}",
                    f"reference_fem.splittings={max(0, level)}",
                    f"reference_fem.cell_size={BASE * 2.0**-level} mm",
                    "reference_fem.newton_tolerance=1e-7", "--out", out],
                   check=True, stderr=subprocess.DEVNULL)
    return json.loads((out / "manifest.json").read_text())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("cases", nargs="*", choices=[*CASES, []], default=[])
    arguments = parser.parse_args()
    for case in arguments.cases or CASES:
        family, degrees, levels = CASES[case]
        folder = HERE / family / "records"
        folder.mkdir(exist_ok=True)
        table, notes = folder / "levels.csv", folder / "levels.json"
        rows = [row for row in csv.DictReader(table.open())] if table.is_file() else []
        rows = [row for row in rows if row["case"] != case]
        manifests = json.loads(notes.read_text()) if notes.is_file() else {}
        for degree in degrees:
            for level in levels:
                with tempfile.TemporaryDirectory() as scratch:
                    out = Path(scratch) / "run"
                    manifest = run(arguments.program, case, degree, level, out)
                    for name, value in quantities(out).items():
                        rows.append({"case": case, "degree": degree, "level": level,
                                     "unknowns": int(manifest["numbers"]["unknowns"]),
                                     "processor_seconds": round(manifest["processor_seconds"], 2),
                                     "quantity": name, "value": repr(value)})
                manifests[f"{case}_q{degree}_level{level}"] = manifest
        with table.open("w", newline="") as stream:
            writer = csv.DictWriter(stream, ["case", "degree", "level", "unknowns",
                                             "processor_seconds", "quantity", "value"])
            writer.writeheader()
            writer.writerows(rows)
        notes.write_text(json.dumps(manifests, indent=1) + "\n")
        print(case, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
