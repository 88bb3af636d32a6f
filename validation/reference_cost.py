#!/usr/bin/env python3
"""What the finite element reference costs on the beam in a channel, and how far its tip is then from the converged
solution, over the whole run.

    validation/reference_cost.py --program build/release/bin/sprung-reference [--repeats 3] [--finest]

Processor seconds are medians; they count one thread on whatever machine this is. The tip's error is the largest
distance of its x displacement from the converged run's, over 0 <= t <= 3 s, as a part of the largest displacement,
and from t = 0.2 s on as a part of the displacement at that time (before, it is nearly nothing).
Writes validation/beam_in_channel/records/cost.csv and cost.json (the manifests).
"""

import argparse
import csv
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent / "beam_in_channel"
# The default mesh, whose own error the error bar puts at 0.05 % of the tip, with half the step. --finest takes
# half the cells and a quarter of the step instead: minutes.
USUAL = {"time_step": "5 ms"}
FINEST = {"cell_size": "10 mm", "splittings": 2, "time_step": "2.5 ms"}
VARIANTS = {
    "default": {},
    "40 mm": {"cell_size": "40 mm", "splittings": 0},
    "40 mm, steps of 20 ms": {"cell_size": "40 mm", "splittings": 0, "time_step": "20 ms"},
    "60 mm, steps of 20 ms": {"cell_size": "60 mm", "splittings": 0, "time_step": "20 ms"},
    "60 mm, steps of 40 ms": {"cell_size": "60 mm", "splittings": 0, "time_step": "40 ms"},
}


def run(program: str, keys: dict, out: Path) -> tuple[dict, np.ndarray]:
    subprocess.run([program, HERE / "scene.toml", *(f"reference_fem.{k}={v}" for k, v in keys.items()),
                    "--out", out, "--overwrite"], check=True, stderr=subprocess.DEVNULL)
    tip = np.loadtxt(out / "probes" / "tip.csv", delimiter=",", skiprows=1)
    return json.loads((out / "manifest.json").read_text()), tip


def errors(tip: np.ndarray, finest: np.ndarray) -> tuple[float, float]:
    """Of the largest displacement over the whole run; of the displacement from 0.2 s on."""
    # At the run's own times, by the finest one's neighbours: its steps are short enough.
    true = np.interp(tip[:, 0], finest[:, 0], finest[:, 1])
    distance, late = np.abs(tip[:, 1] - true), tip[:, 0] >= 0.2 - 1e-9
    return distance.max() / np.abs(finest[:, 1]).max(), (distance[late] / np.abs(true[late])).max()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--finest", action="store_true")
    arguments = parser.parse_args()
    rows, manifests = [], {}
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "run"
        manifests["finest"], finest = run(arguments.program, FINEST if arguments.finest else USUAL, out)
        for name, keys in VARIANTS.items():
            seconds = []
            for _ in range(arguments.repeats):
                manifest, tip = run(arguments.program, keys, out)
                seconds.append(manifest["processor_seconds"])
            manifests[name] = manifest
            of_largest, of_current = errors(tip, finest)
            row = {"variant": name, "unknowns": int(manifest["numbers"]["unknowns"]),
                   "steps": int(manifest["numbers"]["steps"]),
                   "processor_seconds": round(statistics.median(seconds), 3),
                   "repeats": arguments.repeats,
                   "tip_error": f"{of_largest:.3g}", "tip_error_after_0.2s": f"{of_current:.3g}"}
            row |= {phase["phase"]: round(phase["seconds"], 3) for phase in manifest["cost"]}
            rows.append(row)
            print(row, flush=True)
    with (HERE / "records" / "cost.csv").open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    (HERE / "records" / "cost.json").write_text(json.dumps(manifests, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
