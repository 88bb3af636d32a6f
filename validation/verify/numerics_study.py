#!/usr/bin/env python3
"""numerics_study.py --program sprung-sph --out DIR [--quick] [--accept]: what each choice of [numerics] costs and buys.

Taylor-Green vortices at Re = 100 (100 x 100; --quick 50 x 50), the lid-driven cavity at Re = 100 (50 x 50) and the
start of plane Couette flow (40 across; --quick 20), once per choice, every other setting as recommended. Leaves
DIR/numerics.csv: error and processor time of each, with what made them in its first lines. --accept keeps the table as validation/numerics_study/numerics.csv.
"""

import statistics
import sys
from pathlib import Path

import measures
from verify import ROOT, Runner, facts, keep_file, say, study_parser, write_whole

from record import Record  # noqa: I001  (scene.py made the reader known)

CHOICES = [
    [],
    ["numerics.preset=paper"],
    ["numerics.smoothing_length_ratio=1.0"],
    ["numerics.smoothing_length_ratio=1.5"],
    ["numerics.smoothing_length_ratio=2.0"],
    ["numerics.gradient_correction=false"],
    ["numerics.shifting=none"],
    ["numerics.shifting=xu"],
    ["numerics.shifting=fickian"],
    ["numerics.shifting_coefficient=3"],
    ["numerics.shifting_coefficient=9"],
    ["numerics.volume_along_step=false"],
    ["numerics.density_feedback=0"],
    ["numerics.density_feedback=0.5"],
    ["numerics.void_feedback=0"],
    ["numerics.pressure_tolerance=1e-2"],
    ["numerics.pressure_tolerance=1e-5"],
    ["numerics.courant=0.2"],
    ["numerics.position_update=mean_velocity"],
    ["numerics.pressure_solver=bicgstab"],
    ["numerics.pressure_solver=jacobi_cg"],
    ["numerics.pressure_solver=incomplete_cholesky"],
    ["numerics.pressure_solver=cholmod"],
    ["numerics.pressure_solver=boomeramg"],
]

ENERGY = {"kind": "energy", "exact": "taylor_green"}
VELOCITY = {"kind": "particles", "exact": "taylor_green"}


def ghia(component: str) -> dict:
    probe, along, letter = ("vertical", "y", "u") if component == "x" else ("horizontal", "x", "v")
    return {"kind": "literature", "probe": probe, "along": along, "component": component, "from": "18 s",
            "file": f"ghia_1982_{letter}.csv", "column": "re_100", "scale": "1 m/s"}


# Scene, its checks by the column they fill.
SUBJECTS = {
    "taylor_green": {"energy_error": ENERGY, "velocity_error": VELOCITY},
    "cavity": {"u_error": ghia("x"), "v_error": ghia("y")},
    "start_up_couette": {"profile_error": {"kind": "profile", "probe": "section", "exact": "start_up_couette",
                                           "scale": "1 m/s"}},
}
COLUMNS = ["choice", *(f"{subject}_{column}" for subject, checks in SUBJECTS.items()
                       for column in [*checks, "processor_seconds", "outcome"])]


def measure_choice(runner: Runner, out: Path, choice: list, spacing: dict) -> tuple[dict, list]:
    """A row of the table, and the facts of its runs."""
    name = ",".join(choice).replace("numerics.", "") or "recommended"
    row, made = {"choice": name}, []
    for subject, checks in SUBJECTS.items():
        folder, case = out / "runs" / name / subject, ROOT / "validation" / subject
        fault = runner.run(f"{subject} {name}", case / "scene.toml", [f'sph.spacing="{spacing[subject]}"', *choice], folder)
        if fault:
            row[f"{subject}_outcome"] = fault
            continue
        record = Record(folder, name)
        made.append(facts(record, folder))
        row[f"{subject}_processor_seconds"] = f"{made[-1]['processor_seconds']:.2f}"
        row[f"{subject}_outcome"] = made[-1]["outcome"].split(",")[0]  # the table's own separator
        for column, check in checks.items() if record.finished else ():
            row[f"{subject}_{column}"] = f"{measures.measure(record, check, case).error:.5f}"
    return row, made


def table(rows: list, made: list, spacing: dict) -> str:
    def one(key):
        return " and ".join(sorted({str(run[key]) for run in made}))

    loads = [run["load_at_start"] for run in made if run["load_at_start"] is not None]
    lines = ["# What each choice of [numerics] costs and buys, all else as recommended; made by ./sprung study numerics.",
             f"# Taylor-Green Re = 100, spacing {spacing['taylor_green']}, to t = 1: largest relative error of the kinetic"
             " energy; L2 error of the particles' velocity.",
             f"# Cavity Re = 100, spacing {spacing['cavity']}, to t = 20: rms against Ghia et al. 1982 over the lid's speed.",
             f"# Couette start-up, spacing {spacing['start_up_couette']}: rms of the profile over five times over the wall's"
             " speed.",
             f"# commit {one('commit')}, clean {one('clean')}, {one('processor')}, {one('threads')} thread; load of the"
             f" machine at the start of a run, median {statistics.median(loads):.1f}: above its cores, times are upper bounds.",
             ",".join(COLUMNS)]
    return "\n".join(lines + [",".join(row.get(column, "") for column in COLUMNS) for row in rows]) + "\n"


def main() -> int:
    options = study_parser("numerics").parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    spacing = {"taylor_green": "20 mm" if options.quick else "10 mm", "cavity": "20 mm",
               "start_up_couette": "50 mm" if options.quick else "25 mm"}
    runner = Runner(options.program, 1, options.time_limit)
    rows, made = [], []
    for choice in CHOICES:
        row, runs = measure_choice(runner, out, choice, spacing)
        rows.append(row)
        made += runs
        if made:
            write_whole(out / "numerics.csv", table(rows, made, spacing))
    if not made:
        say("no run gave a record")
        return 6
    print((out / "numerics.csv").read_text(), end="")
    if options.accept:
        keep_file(out / "numerics.csv", ROOT / "validation" / "numerics_study")
    return 0


if __name__ == "__main__":
    sys.exit(main())
