#!/usr/bin/env python3
"""hard_figures.py DIR: draws DIR/<row>.png for every row of DIR/hard.json (./sprung study hard). Never runs a solver.

Left: the last field of the row's first run (solids black, fluid by its speed); right: the first two figures that have a
curve, a line a run, with their limits.
"""

import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "scene"))

import style  # noqa: E402  (chooses matplotlib's backend)
from record import Record  # noqa: E402

import matplotlib.pyplot as plt  # noqa: E402

SOLID, FLUID = 0.0, 1.0
MOST_LINES = 8  # with a label each


def draw_field(axes, figure, folder: Path, name: str) -> None:
    record = Record(folder, name)
    time = record.snapshot_times()[-1]
    snapshot = record.snapshot(time)
    role, places = snapshot.fields["role"], snapshot.positions
    speed = np.linalg.norm(snapshot.fields["velocity"], axis=1)
    fluid = role == FLUID
    size = 9000.0 / max(len(places), 400)
    shown = axes.scatter(places[fluid, 0], places[fluid, 1], c=speed[fluid], s=size, marker="s", linewidths=0,
                         cmap="viridis", vmin=0.0, vmax=np.percentile(speed[fluid], 99.5), rasterized=True)
    axes.scatter(places[role == SOLID, 0], places[role == SOLID, 1], c="black", s=size, marker="s", linewidths=0)
    figure.colorbar(shown, ax=axes, shrink=0.7, label="speed [m/s]")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=f"{name}, t = {time:.4g} s")
    axes.grid(False)


def draw_curves(axes, name: str, measured: dict) -> None:
    for position, curve in enumerate(measured["curves"]):
        colour = plt.cm.viridis(0.9 * position / max(1, len(measured["curves"]) - 1))
        axes.plot(curve["axis"], curve["found"], color=colour, linewidth=1.0,
                  label=curve["label"] if position < MOST_LINES else None)
    for limit in measured["limit"].split(" and "):
        bound = float(limit.split()[1])
        low, high = axes.get_ylim()
        if measured["kind"] in ("series", "closest_pair", "solid_over_fluid", "body_gap", "wall_gap") and \
                low - 2 * (high - low) < bound < high + 2 * (high - low):
            axes.axhline(bound, color=style.REFERENCE, linewidth=0.8, dashes=(4, 2))
    axes.set(xlabel=measured["axes"][0], ylabel=measured["axes"][1], title=f"{name}: {measured['verdict']}")
    axes.legend(fontsize=7)


def draw(row: dict, folder: Path, file: Path) -> None:
    curves = [(name, f) for name, f in row["figures"].items() if f["curves"]][:2]
    fields = [(name, run["folder"]) for name, run in row["runs"].items() if "folder" in run]
    figure, axes = plt.subplots(1, 1 + len(curves), figsize=(4.6 * (1 + len(curves)), 3.6), layout="constrained",
                                squeeze=False)
    draw_field(axes[0][0], figure, folder / fields[0][1], fields[0][0])
    for panel, (name, measured) in zip(axes[0][1:], curves):
        draw_curves(panel, name, measured)
    figure.suptitle(f"{row['title']}: {row['verdict']}", x=0.01, ha="left")
    style.save(figure, file)


def main() -> int:
    if len(sys.argv) != 2 or not (Path(sys.argv[1]) / "hard.json").exists():
        print("hard_figures.py takes the folder that ./sprung study hard leaves", file=sys.stderr)
        return 2
    folder = Path(sys.argv[1])
    for name, row in json.loads((folder / "hard.json").read_text())["rows"].items():
        if any("folder" in run for run in row["runs"].values()):
            draw(row, folder, folder / f"{name}.png")
            print(folder / f"{name}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
