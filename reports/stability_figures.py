#!/usr/bin/env python3
"""stability_figures.py DIR: draws DIR/stability.png from DIR/stability.csv (./sprung study stability): brackets of the
largest stable step, the automatic step, and theory, over stiffness, viscosity and spacing. Never runs a solver."""

import csv
import sys
from pathlib import Path

import style  # chooses matplotlib's backend

import matplotlib.pyplot as plt  # noqa: E402

AXES = {"stiffness": "Young's modulus [Pa]", "viscosity": "viscosity [Pa s]", "spacing": "spacing [m]"}
LOOKS = {"printed": ("#0072b2", "o"), "symplectic": ("#009e73", "s"), "recommended": ("#c1272d", "D")}


def number(text: str) -> float | None:
    return float(text) if text not in ("", "inf") else None


def draw(rows: list[dict], file: Path) -> None:
    figure, axes = plt.subplots(1, len(AXES), figsize=(4.4 * len(AXES), 4.0), layout="constrained", sharey=True)
    for panel, (varied, label) in zip(axes, AXES.items()):
        for integrator, (colour, mark) in LOOKS.items():
            here = sorted((r for r in rows if r["integrator"] == integrator and r["varied"] == varied),
                          key=lambda r: float(r["value"]))
            if not here:
                continue
            x = [float(r["value"]) for r in here]
            for place, row in zip(x, here):
                low, high = number(row["stable"]), number(row["unstable"])
                if low:
                    panel.plot([place], [low], mark, color=colour, markersize=5)
                if low and high:
                    panel.plot([place, place], [low, high], color=colour, linewidth=2.2)
                elif low:
                    panel.annotate("stable above", (place, low), xytext=(0, 6), textcoords="offset points",
                                   fontsize=6, ha="center", color=colour)
            panel.plot(x, [float(r["automatic"]) for r in here], mark, color=colour, fillstyle="none", markersize=5)
            theory = [(a, number(r["theory"])) for a, r in zip(x, here) if number(r["theory"])]
            panel.plot(*zip(*theory), color=colour, linewidth=0.9, dashes=(4, 2))
        panel.set(xscale="log", yscale="log", xlabel=label)
    axes[0].set_ylabel("time step [s]")
    for integrator, (colour, mark) in LOOKS.items():
        axes[0].plot([], [], mark, color=colour, label=f"{integrator}, largest stable")
    axes[0].plot([], [], "o", color="#777777", fillstyle="none", label="automatic")
    axes[0].plot([], [], color="#777777", dashes=(4, 2), label="theory")
    axes[0].legend(fontsize=7)
    figure.suptitle("Largest stable time step, and the one taken", x=0.01, ha="left")
    beside = file.with_name("new_" + file.name)
    figure.savefig(beside, dpi=style.DPI)
    plt.close(figure)
    beside.replace(file)


if __name__ == "__main__":
    if len(sys.argv) != 2 or not (Path(sys.argv[1]) / "stability.csv").exists():
        sys.exit("stability_figures.py takes the folder that ./sprung study stability leaves")
    table = Path(sys.argv[1]) / "stability.csv"
    lines = [line for line in table.read_text().splitlines() if not line.startswith("#")]
    draw(list(csv.DictReader(lines)), table.with_suffix(".png"))
