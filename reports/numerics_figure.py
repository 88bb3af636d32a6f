#!/usr/bin/env python3
"""numerics_figure.py TABLE PICTURE: error against processor time for the choices of [numerics], from numerics.csv."""

import csv
import sys
import textwrap
from pathlib import Path

import style  # chooses matplotlib's backend

import matplotlib.pyplot as plt  # noqa: E402

PANELS = [("taylor_green_energy_error", "taylor_green_processor_seconds", "Taylor-Green Re = 100: error of kinetic energy"),
          ("taylor_green_velocity_error", "taylor_green_processor_seconds", "Taylor-Green Re = 100: L2 error of velocity"),
          ("cavity_u_error", "cavity_processor_seconds", "Cavity Re = 100: u against Ghia"),
          ("start_up_couette_profile_error", "start_up_couette_processor_seconds", "Couette start-up: rms of the profile")]
GROUPS = {"recommended": "#c1272d", "pressure_solver": "#0072b2", "pressure_tolerance": "#56b4e9",
          "smoothing_length_ratio": "#009e73", "shifting": "#e69f00", "density_feedback": "#cc79a7"}


def read(file: Path) -> list[dict]:
    return list(csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#")))


def colour(choice: str) -> str:
    return next((c for group, c in GROUPS.items() if choice.startswith(group)), style.REFERENCE)


def label_beside(panel, points: list) -> None:
    """Names in a column at the right, in the order of the errors, each with a line to its point."""
    for rank, (x, y, choice) in enumerate(sorted(points, key=lambda p: p[1])):
        panel.annotate(choice.replace("=", " "), (x, y), xytext=(1.06, (rank + 0.5) / len(points)),
                       textcoords="axes fraction", fontsize=7, color=colour(choice), va="center", annotation_clip=False,
                       arrowprops={"arrowstyle": "-", "color": colour(choice), "linewidth": 0.4, "relpos": (0.0, 0.5)})


def draw(rows: list[dict], file: Path) -> None:
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 8.6), layout="constrained")
    for panel, (error, time, title) in zip(axes.flat, PANELS):
        points = [(float(r[time]), float(r[error]), r["choice"]) for r in rows if r[error] and r[time]]
        for x, y, choice in points:
            panel.loglog(x, y, "o", color=colour(choice), markersize=7 if choice == "recommended" else 4)
        missing = [r["choice"] for r in rows if not r[error]]
        note = "\n" + textwrap.fill(f"not finished: {', '.join(missing)}", 60) if missing else ""
        panel.set(title=title, xlabel="processor time [s]" + note, ylabel="error")
        panel.margins(y=0.08)
        label_beside(panel, points)
    style.save(figure, file)


if __name__ == "__main__":
    if len(sys.argv) != 3 or not Path(sys.argv[1]).exists():
        sys.exit("numerics_figure.py takes the table of ./sprung study numerics and the picture to write")
    draw(read(Path(sys.argv[1])), Path(sys.argv[2]))
