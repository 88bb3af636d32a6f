#!/usr/bin/python3 -B
"""Stands in for sprung-sph: `formula_solver.py run SCENE OVERRIDE... --out DIR ...` answers with a record made of the
exact solution of start-up Poiseuille flow, off by (spacing / 1 m)^ORDER. FORMULA_SOLVER_ORDER sets ORDER (else 2);
a scene whose title says so is refused (exit 1), or stops itself (exit 3)."""

import json
import os
import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "validation" / "verify"))

import exact  # noqa: E402
from scene import Scene  # noqa: E402

from record import quantity  # noqa: E402


def main() -> int:
    words = sys.argv[2:]
    out = Path(words[words.index("--out") + 1])
    toml = Path(words[0]).read_text()
    table = tomllib.loads(toml)
    for word in words[1:]:
        if "=" in word and not word.startswith("-"):
            path, value = word.split("=", 1)
            group, key = path.split(".")
            table[group][key] = value.strip('"')
    if "refused" in table["title"]:
        print("error: refused", file=sys.stderr)
        return 1
    scene = Scene(table)
    flow = exact.ForcedChannel(scene)
    out.mkdir(parents=True, exist_ok=True)
    runs = out / "runs"
    runs.write_text(runs.read_text() + "x" if runs.exists() else "x")
    error = scene.spacing ** float(os.environ.get("FORMULA_SOLVER_ORDER", "2"))
    places = np.column_stack([np.full(21, 0.4), np.linspace(0.0, 1.0, 21), np.zeros(21)])
    with h5py.File(out / "record.h5", "w") as file:
        for name in ("series", "fields"):
            file.create_group(name)
        for number, text in enumerate(table["probes"]["section"]["times"]):
            u = flow.velocity(places, quantity(text))[:, 0] + error
            data = file.create_dataset(f"tables/section/{number:06d}",
                                       data=np.column_stack([places[:, :2], u, np.zeros_like(u)]))
            data.attrs["columns"], data.attrs["units"] = ["x", "y", "velocity_x", "velocity_y"], ["m", "m", "m/s", "m/s"]
            data.attrs["time"] = quantity(text)
    stopped = "stops" in table["title"]
    resolved = toml.replace('spacing = "50 mm"', f'spacing = "{table["sph"]["spacing"]}"')
    manifest = {"outcome": "stopped: as asked" if stopped else "finished", "scene_toml": resolved,
                "numbers": {"particles": 100.0, "steps": 7.0, "time_step": 0.1}, "processor_seconds": 1.5,
                "wall_seconds": 2.0, "peak_memory_bytes": 1.0, "threads": 1, "commit": "none", "clean": "yes",
                "processor": "formula"}
    (out / "manifest.json").write_text(json.dumps(manifest))
    return 3 if stopped else 0


if __name__ == "__main__":
    sys.exit(main())
