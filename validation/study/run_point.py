#!/usr/bin/env python3
"""run_point.py CASE-FOLDER NAME --repeat N --program PROGRAM --out FILE [--time-limit SECONDS]: one run of a cost study.

NAME is a point of CASE-FOLDER/cost.toml (CURVE.NUMBER) or a level of its truth (truth.0 to truth.2). Runs the solver
on one thread, or goes on with a run that was stopped, and leaves FILE, JSON: the numbers that the study compares, what
they cost, and what made them. The record itself is then deleted. A run that stopped itself or ran out of time is an
answer, too: FILE says so. Exit code 6: the solver refused or failed.
"""

import argparse
import json
import shutil
import sys
from pathlib import Path

import block_point
import plan as plans
import quantities

from verify import Runner, facts, say, write_whole  # noqa: I001  (quantities.py made the drivers known)

from record import Record

NO_RUN = 6


def numbers_of(record: Record, wanted: dict) -> tuple[dict, dict]:
    """(numbers by quantity, causes of what is missing by quantity)."""
    found, missing = {}, {}
    for name, one in wanted.items():
        try:
            found[name] = quantities.take(record, one).tolist()
        except quantities.Missing as cause:
            missing[name] = str(cause)
    return found, missing


def answer_of(record: Record, folder: Path, wanted: dict) -> dict:
    found, missing = numbers_of(record, wanted)
    counts = record.manifest["numbers"]
    return {**facts(record, folder), "started": record.manifest["start_time_utc"],
            "resumed": bool(record.manifest.get("resumed")),
            "unknowns": int(counts.get("unknowns", counts.get("particles", 0))),
            "phases": {entry["phase"]: entry["seconds"] for entry in record.manifest.get("cost", [])},
            "numbers": found, "missing": missing}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path)
    parser.add_argument("name")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--time-limit", type=float)
    options = parser.parse_args()
    plan = plans.read(options.case.resolve())
    curve, number = options.name.rsplit(".", 1)
    if curve == "truth":
        solver, overrides = "reference", plan.levels()[int(number)]
    else:
        point = plan.point(options.name)
        solver, overrides = point.solver, point.overrides
    if plan.block:
        return block_point.run(plan, plan.point(options.name), options.repeat, options.program.resolve(), options.out)
    runner = Runner(options.program.resolve(), 1, options.time_limit, ["run"] if solver == "particles" else [])
    folder = options.out.resolve().with_suffix(".record")
    label = f"{plan.case.name} {options.name}, run {options.repeat}"
    fault = runner.run(label, plan.scene(solver), list(overrides), folder)
    setting = {"case": plan.case.name, "name": options.name, "repeat": options.repeat, "solver": solver,
               "overrides": list(overrides)}
    if "refused or failed" in fault:
        say(f"{label}: {fault}")
        return NO_RUN
    if fault:  # the time limit: what stands there so far says how long it would take
        answer = {"outcome": fault, "numbers": {}, "missing": {name: fault for name in plan.quantities}}
    else:
        answer = answer_of(Record(folder, options.name), folder, plan.quantities)
    write_whole(options.out, json.dumps({**setting, **answer}, indent=1) + "\n")
    for suffix in (".answered", ".asked", ".load"):  # first, so that half a record never passes for an answer
        folder.with_name(folder.name + suffix).unlink(missing_ok=True)
    shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
