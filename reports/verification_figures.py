#!/usr/bin/env python3
"""verification_figures.py FOLDER: draws FOLDER/verification.png from FOLDER/verification.json and its records.

A row per series: errors over spacing with the slope that was measured; what was found over what is exact, of the
first check that has a curve; the finest field. Reads records, never runs a solver.
"""

import json
import sys
import tomllib
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "scene"))

import style  # noqa: E402  (chooses matplotlib's backend)
from record import Record, quantity  # noqa: E402

import matplotlib.pyplot as plt  # noqa: E402

COLOURS = ["#c1272d", "#0072b2", "#009e73", "#e69f00", "#cc79a7", "#56b4e9"]
MARKS = "osD^vP"
FLUID = 1.0


def draw_errors(axes, series: dict) -> None:
    """log error over log spacing for every check that has more than one error."""
    for position, (name, check) in enumerate(series["checks"].items()):
        points = [(quantity(s), e) for s, e in check["errors"].items() if e > 0.0]
        if not points or check["kind"] == "steps":
            continue
        x, y = np.array(points).T
        colour = COLOURS[position % len(COLOURS)]
        order = "" if check["order"] is None else f", order {check['order']:.2f}"
        axes.loglog(x, y, MARKS[position % len(MARKS)] + "-", color=colour, label=name + order, markersize=4)
        for verdict in check["verdicts"]:
            if verdict["of"].startswith("error at"):
                at, most = quantity(verdict["of"].removeprefix("error at ")), float(verdict["limit"].split()[1])
                axes.plot([at / 1.12, at * 1.12], [most, most], color=colour, linewidth=2.2, solid_capstyle="butt")
    spacings = np.array([quantity(s) for s in series["spacings"]])
    lowest = axes.get_ylim()
    guide = np.sqrt(lowest[0] * lowest[1]) * (spacings / np.sqrt(spacings[0] * spacings[-1])) ** 2
    axes.loglog(spacings, guide, color="#999999", linewidth=0.8, dashes=(2, 2), label="slope 2")
    axes.set(xlabel="spacing [m]", ylabel="error, bars: limits", title=series["title"])
    axes.set_xticks(spacings, [f"{s:.4g}" for s in spacings])
    axes.minorticks_off()
    axes.legend(fontsize=7)


def draw_curves(axes, series: dict) -> None:
    """Exact as lines, found as marks, of the first check with curves."""
    drawn = [(name, check) for name, check in series["checks"].items()
             if any(len(curve["axis"]) > 2 for curve in check["curves"])]
    if not drawn:
        axes.set_axis_off()
        return
    name, check = drawn[0]
    curves = check["curves"]
    if len(curves) > 6:
        curves = [curves[i] for i in np.unique(np.linspace(0, len(curves) - 1, 6).astype(int))]
    for position, curve in enumerate(curves):
        colour = COLOURS[position % len(COLOURS)]
        if curve["found"]:
            step = max(1, len(curve["found"]) // 40) if curve["exact"] else 1
            look = "o" if curve["exact"] else "-"
            axes.plot(curve["axis"][::step], curve["found"][::step], look, color=colour, markersize=2.5,
                      label=curve["label"])
        if curve["exact"]:
            ordered = np.argsort(curve["axis"])
            points = not curve["found"]
            axes.plot(np.array(curve["axis"])[ordered], np.array(curve["exact"])[ordered], "s" if points else "-",
                      color=style.REFERENCE, linewidth=0.8, markersize=3, fillstyle="none",
                      label=curve["label"] if points else None, zorder=1 if not points else 3)
    if check["kind"] == "mean":  # an impulsive start may stand far above the rest
        late = np.concatenate([c["found"][len(c["found"]) // 20:] + c["exact"] for c in curves])
        room = 0.15 * max(np.ptp(late), 1e-9)
        axes.set_ylim(np.min(late) - room, np.max(late) + room)
    axes.set(xlabel=check["axes"][0], ylabel=check["axes"][1],
             title=f"{name}, finest: marks found, lines exact" if curves[-1]["found"] else f"{name}, finest")
    axes.legend(fontsize=7)


def finest_record(series: dict, folder: Path) -> Record | None:
    runs = [run for run in series["runs"].values() if "folder" in run]
    return Record(folder / runs[-1]["folder"], "finest") if runs else None


def draw_field(axes, record: Record | None) -> None:
    """Speed of the particles at the last snapshot; of a 3D run those of a layer in the middle."""
    if record is None or not record.snapshot_times():
        axes.set_axis_off()
        return
    snapshot = record.snapshot(record.snapshot_times()[-1])
    scene = tomllib.loads(record.manifest["scene_toml"])
    spacing = quantity(scene["sph"]["spacing"])
    box = [[quantity(t) for t in scene["domain"]["channel"][end]] for end in ("from", "to")]
    fluid = snapshot.fields["role"] == FLUID
    places, velocity = snapshot.positions[fluid], snapshot.fields["velocity"][fluid]
    plane = (0, 1)
    if len(box[0]) == 3:
        # A layer across the longest part of the flow's cross-section: the first axis is the flow's in pipes.
        plane = (2, 1) if "curved_wall" in scene else (0, 1)
        across = ({0, 1, 2} - set(plane)).pop()
        middle = 0.5 * (box[0][across] + box[1][across])
        layer = np.abs(places[:, across] - middle) < 0.6 * spacing
        places, velocity = places[layer], velocity[layer]
    speed = np.linalg.norm(velocity, axis=1)
    extent = max(box[1][d] - box[0][d] for d in plane)
    size = (3.5 * 72 * spacing / extent) ** 2  # a panel is about 3.5 inches wide
    artist = axes.scatter(places[:, plane[0]], places[:, plane[1]], c=speed, s=size, marker="s", linewidths=0,
                          cmap="viridis", rasterized=True)
    axes.set(aspect="equal", xlabel=f"{'xyz'[plane[0]]} [m]", ylabel=f"{'xyz'[plane[1]]} [m]",
             title=f"speed [m/s], finest, t = {snapshot.time:.4g} s")
    axes.grid(False)
    axes.figure.colorbar(artist, ax=axes, shrink=0.8)


def draw(folder: Path) -> Path:
    result = json.loads((folder / "verification.json").read_text())
    rows = len(result["series"])
    figure, axes = plt.subplots(rows, 3, figsize=(13.5, 3.7 * rows), layout="constrained", squeeze=False)
    figure.suptitle(result["title"], x=0.01, ha="left", fontsize=11)
    for row, series in zip(axes, result["series"].values()):
        draw_errors(row[0], series)
        draw_curves(row[1], series)
        draw_field(row[2], finest_record(series, folder))
    file = folder / "verification.png"
    beside = file.with_name("verification.new.png")
    figure.savefig(beside)
    plt.close(figure)
    beside.replace(file)
    return file


if __name__ == "__main__":
    if len(sys.argv) != 2 or not (Path(sys.argv[1]) / "verification.json").exists():
        sys.exit("verification_figures.py takes the folder of a verification, with verification.json in it")
    print(f"picture: {draw(Path(sys.argv[1]))}")
