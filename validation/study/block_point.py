"""One run of a cost study of blocks of material (cost.toml's block = true): a point's overrides are options.

Particles: sprung-calibrate cube OPTIONS; the finite elements: sprung-reference-solid OPTIONS. Both leave a table with
one row that counts, the last. Times are those of the whole process, by what the system counts for it; memory is what the
program says in its manifest, for the system's count keeps what the process was before: this launcher.
"""

import csv
import json
import os
import shutil
import subprocess
import sys
import time
from datetime import datetime, timezone
from pathlib import Path

import plan as plans

from verify import say, write_whole  # noqa: I001  (plan.py made the driver known)

NO_RUN = 6


def processor() -> str:
    names = [line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
             if line.startswith("model name")]
    return names[0] if names else "unknown"


def measured(command: list) -> tuple[int, dict]:
    """(exit code, cost of the process). wait4 counts this child alone, whatever ran before it."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
    load, began = os.getloadavg()[0], time.monotonic()
    started = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    child = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL, stderr=sys.stderr, env=environment)
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, {"processor_seconds": used.ru_utime + used.ru_stime, "wall_seconds": time.monotonic() - began,
                              "threads": 1, "started": started,
                              "load_at_start": round(load, 2), "processor": processor()}


def strain_of(row: dict) -> float:
    """Of the middle half, particles; of the block, which is in one state, finite elements."""
    if "strain_middle_half" in row:
        return float(row["strain_middle_half"])
    return float(row["stretch_x [1]"]) - 1.0


def unknowns_of(row: dict, overrides: tuple) -> int:
    """Particles; or degrees of freedom of a block of quadratic displacements and linear, discontinuous pressures."""
    if "layers" in row:
        return int(row["layers"]) ** 3
    cells = next((word.split("=", 1)[1].split() for word in overrides if word.startswith("--cells=")), ["2", "2", "2"])
    nodes, elements = 3, 4
    for count in cells:
        nodes, elements = nodes * (2 * int(count) + 1), elements * int(count)
    return nodes + elements


def run(plan: plans.Plan, point: plans.Point, repeat: int, program: Path, out: Path) -> int:
    folder = out.resolve().with_suffix(".block")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    table = folder / "cube.csv"
    words = [word for text in point.overrides for word in text.replace("=", " ", 1).split()]
    command = ([program, "--out", folder, "cube", *words] if point.solver == "particles"
               else [program, *words, "--out", table])
    say(f"{plan.case.name} {point.name}, run {repeat}: running")
    code, cost = measured(command)
    if code != 0:
        say(f"{plan.case.name} {point.name}: the program refused or failed, exit code {code}")
        return NO_RUN
    row = list(csv.DictReader(table.read_text().splitlines()))[-1]
    made = json.loads(table.with_suffix(".json").read_text())
    made = made.get("run", made)
    answer = {"case": plan.case.name, "name": point.name, "repeat": repeat, "solver": point.solver,
              "overrides": list(point.overrides), "outcome": "finished", **cost,
              "peak_memory_bytes": made["peak_memory_bytes"], "commit": made["commit"],
              "clean": made["clean"], "resumed": False, "unknowns": unknowns_of(row, point.overrides),
              "steps": int(row.get("steps", row.get("newton_iterations [1]", 0))), "time_step": 0.0, "phases": {},
              "numbers": {name: [[strain_of(row)]] for name in plan.quantities}, "missing": {}}
    write_whole(out, json.dumps(answer, indent=1) + "\n")
    shutil.rmtree(folder, ignore_errors=True)
    return 0
