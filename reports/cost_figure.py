#!/usr/bin/env python3
"""cost_figure.py TABLE MANIFEST PICTURE: error against processor time and memory, from a cost study's table.

Lines join the points of one curve; the thick ones are the fronts, the settings that no other of the same solver beats
in both. The grey band is the truth's own error: no point in it is told apart from a perfect one. Bars are the least
and the most of the repeats. Dotted: the floor of a curve that spans no decade of error. Where curves have a limit of
their own (the finest of what they change), a third panel shows the distance from it: what that choice alone costs.
"""

import csv
import json
import math
import sys
import textwrap
from pathlib import Path

import style  # chooses matplotlib's backend

import matplotlib.pyplot as plt  # noqa: E402

COLOURS = {"particles": "#c1272d", "reference": style.REFERENCE}
WORDS = {"particles": "particles", "reference": "finite elements"}
MARKS = "osD^vP*X<>"


def read(file: Path) -> list[dict]:
    rows = list(csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#")))
    return [row for row in rows if row["error"] and row["processor_seconds"]]


def front(rows: list[dict], cost: str) -> list[tuple[float, float]]:
    best, least = [], math.inf
    for x, y in sorted((float(row[cost]), float(row["error"])) for row in rows):
        if y < least:
            best.append((x, y))
            least = y
    return best


def by_curve(rows: list[dict]) -> dict:
    """The rows of every curve, in the order of the table."""
    return {curve: [row for row in rows if row["curve"] == curve] for curve in dict.fromkeys(row["curve"] for row in rows)}


def draw_panel(panel, rows: list[dict], about: dict, cost: str, bars: bool) -> None:
    low = lowest(rows, about)
    for number, (curve, own) in enumerate(by_curve(rows).items()):
        x, y = [float(row[cost]) for row in own], [max(float(row["error"]), 1.2 * low) for row in own]
        colour = COLOURS[own[0]["solver"]] if curve in ("spacing", "reference") else style.FURTHER[number % len(style.FURTHER)]
        reach = None
        if bars:
            reach = [[a - float(row[f"{cost}_least"]) for a, row in zip(x, own)],
                     [float(row[f"{cost}_most"]) - a for a, row in zip(x, own)]]
        panel.errorbar(x, y, xerr=reach, color=colour, marker=MARKS[number % len(MARKS)], markersize=4, linewidth=0.7,
                       elinewidth=0.8, label=label(curve, own, about, low))
    for solver, colour in COLOURS.items():
        points = front([row for row in rows if row["solver"] == solver], cost)
        points = [(x, max(y, 1.2 * low)) for x, y in points]
        panel.plot(*zip(*points), color=colour, linewidth=2.6, alpha=0.35, zorder=0) if points else None
    floor = max(about["truth_error"].values())
    panel.set(xscale="log", yscale="log")
    panel.set_ylim(bottom=low)
    if floor > low:
        panel.axhspan(low, floor, color="#d9d9d9", zorder=-1)
        panel.text(0.99, floor, "the truth's own error ", ha="right", va="top", fontsize=7,
                   transform=panel.get_yaxis_transform())


def lowest(rows: list[dict], about: dict) -> float:
    """Bottom of the picture: below every error, but not where one solver's round-off would squeeze the other's curves."""
    floor = max(about["truth_error"].values())
    least = [min(float(row["error"]) for row in rows if row["solver"] == solver)
             for solver in {row["solver"] for row in rows}]
    return max(0.5 * min(least + ([floor] if floor > 0.0 else [])), 0.02 * max(least))


def label(curve: str, own: list[dict], about: dict, low: float) -> str:
    """What the curve is; why it spans no decade, where it does not; how far below the picture it lies."""
    text, span = f"{curve}: {about['curves'][curve]}", about.get("spans", {}).get(curve, {})
    if "floor" in span and span.get("error", {}).get("factor", 10.0) < 10.0:
        text += f"; levels off (dotted): {span['floor']}"
    below = [float(row["error"]) for row in own if float(row["error"]) < low]
    return textwrap.fill(text + (f"; below the picture, {max(below):.1e}" if below else ""), 120)


def draw_floors(panel, rows: list[dict], about: dict) -> None:
    """The least error of every curve that spans no decade and says why, over the width of the curve."""
    for curve, one in about.get("spans", {}).items():
        own = [row for row in rows if row["curve"] == curve]
        if "floor" not in one or len(own) < 3 or one.get("error", {}).get("factor", 10.0) >= 10.0:
            continue
        times, least = [float(row["processor_seconds"]) for row in own], one["error"]["least"]
        if least > lowest(rows, about):
            panel.plot([min(times), max(times)], [least, least], color="#555555", linestyle=":", linewidth=1.0)


def draw_own(panel, rows: list[dict], about: dict) -> None:
    for number, own in enumerate(by_curve(rows).values()):
        own = [row for row in own if row.get("error_own")]
        if own:
            panel.plot([float(row["processor_seconds"]) for row in own], [float(row["error_own"]) for row in own],
                       color=style.FURTHER[number % len(style.FURTHER)], marker=MARKS[number % len(MARKS)], markersize=4,
                       linewidth=0.7)
    panel.set(xscale="log", yscale="log", xlabel="processor time [s]", ylabel="distance from the curve's own limit",
              title="what step and tolerance alone cost")


def draw(rows: list[dict], about: dict, file: Path) -> None:
    low = lowest(rows, about)
    lines = sum(1 + label(curve, own, about, low).count("\n") for curve, own in by_curve(rows).items())
    panels = ["time", "memory"] + (["own"] if any(row.get("error_own") for row in rows) else [])
    figure, axes = plt.subplot_mosaic([panels, ["legend"] * len(panels)], layout="constrained",
                                      figsize=(0.625 * len(panels) * style.WIDTH, 4.8 + 0.2 * lines),
                                      height_ratios=[4.8, 0.2 * lines])
    left, right, legend = axes["time"], axes["memory"], axes["legend"]
    right.sharey(left)
    legend.axis("off")
    draw_panel(left, rows, about, "processor_seconds", bars=True)
    draw_panel(right, rows, about, "memory_MB", bars=False)
    draw_floors(left, rows, about)
    if "own" in axes:
        draw_own(axes["own"], rows, about)
    left.set(xlabel="processor time [s], one thread", ylabel="error (largest of all quantities)", title=about["title"])
    right.set(xlabel="memory [MB], largest resident set", title="the same by memory")
    commits = "; ".join(f"{WORDS[solver]} {', '.join(c[:7] for c in those)}" for solver, those in about["commits"].items())
    legend.legend(*left.get_legend_handles_labels(), loc="center", fontsize=7.5)
    figure.supxlabel(f"commits: {commits}; {', '.join(about['processor'])}", fontsize=6.5)
    style.save(figure, file)


if __name__ == "__main__":
    if len(sys.argv) != 4 or not all(Path(name).exists() for name in sys.argv[1:3]):
        sys.exit("cost_figure.py takes the table and the manifest of ./sprung study cost, and the picture to write")
    measured = read(Path(sys.argv[1]))
    if not measured:
        sys.exit("cost_figure.py: no point of the table has an error and a time: nothing to draw")
    draw(measured, json.loads(Path(sys.argv[2]).read_text()), Path(sys.argv[3]))
