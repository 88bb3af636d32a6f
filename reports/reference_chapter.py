#!/usr/bin/python3
"""The chapter on the finite element reference: every benchmark against its published values.

    reports/reference_chapter.py                                   draws reports/figures/reference_*.png and
                                                                   results/reference_chapter.html
    reports/reference_chapter.py --out results/chapter.html
    reports/reference_chapter.py --keep RUN turek_hron fsi3        keeps a run: its series, thinned to what the
                                                                   chapter needs, and its manifest

Reads kept records (validation/*/records) and published values (validation/*/literature); never runs a solver.
"""

import argparse
import base64
import csv
import html
import json
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.interpolate import CubicSpline

import style

ROOT = Path(__file__).resolve().parent.parent
VALIDATION = ROOT / "validation"
FIGURES = ROOT / "reports" / "figures"
FOUND, PUBLISHED, BAND = style.REFERENCE, style.RUNS["recommended"], "#f3d9da"
NAMES = {"ux": "u_x of the tip", "uy": "u_y of the tip", "drag": "drag", "lift": "lift",
         "pressure_difference": "pressure difference"}
UNITS = {"ux": (1e3, "mm"), "uy": (1e3, "mm"), "drag": (1.0, "N/m"), "lift": (1.0, "N/m")}
# Last whole cycles are judged; a window of this many seconds holds one of every case.
WINDOWS = {"csm3": 0.914, "cfd3": 1.0, "fsi2": 1.04, "fsi3": 0.74}
# Kept runs: folder, benchmark, what sets it apart.
KEPT = [("csm3", "csm3", "Q2"), ("cfd3", "cfd3", "Q3"), ("fsi2_coarse", "fsi2", "Q2"), ("fsi2", "fsi2", "Q3"),
        ("fsi3_coarse", "fsi3", "Q2"), ("fsi3", "fsi3", "Q3")]


# ---------------------------------------------------------------------------------------------- records

def series(run: Path, name: str) -> np.ndarray | None:
    file = run / "probes" / f"{name}.csv"
    return np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2) if file.is_file() else None


def keep(run: Path, family: str, case: str) -> None:
    """series.csv: time and what the chapter draws, nine digits; manifest.json as it is."""
    energy = series(run, "ledger_energy")
    time = energy[:, 0]
    columns = {"time [s]": time}

    def take(table, at, name):
        if table is not None:
            columns[name] = np.interp(time, table[:, 0], table[:, at])

    take(series(run, "tip"), 1, "ux [m]")
    take(series(run, "tip"), 2, "uy [m]")
    forces = [series(run, name) for name in ("force_cylinder", "force_flag", "force")]
    forces = [f for f in forces if f is not None]
    if forces:
        for at, name in ((1, "drag [N/m]"), (2, "lift [N/m]")):
            columns[name] = sum(np.interp(time, f[:, 0], f[:, at]) for f in forces)
    pressure = series(run, "pressure")
    if pressure is not None:
        columns["pressure_difference [Pa]"] = np.interp(time, pressure[:, 0],
                                                        pressure[:, 1] - pressure[:, 2])
    columns["work [J/m]"], columns["imbalance [J/m]"] = energy[:, 5], energy[:, 6]
    folder = VALIDATION / family / "records" / case
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "series.csv").open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows([f"{x:.9g}" for x in row] for row in zip(*columns.values()))
    shutil.copyfile(run / "manifest.json", folder / "manifest.json")


def kept(family: str, case: str) -> dict[str, np.ndarray] | None:
    file = VALIDATION / family / "records" / case / "series.csv"
    if not file.is_file():
        return None
    with file.open(newline="") as stream:
        names = [name.split(" ")[0] for name in next(csv.reader(stream))]
        table = np.loadtxt(stream, delimiter=",", ndmin=2)
    return dict(zip(names, table.T))


def manifest(family: str, case: str) -> dict:
    return json.loads((VALIDATION / family / "records" / case / "manifest.json").read_text())


def rows(file: Path) -> list[dict]:
    if not file.is_file():
        return []
    with file.open(newline="") as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def published(family: str, case: str) -> list[dict]:
    return [r for r in rows(VALIDATION / family / "literature" / "published.csv") if r["case"] == case]


# --------------------------------------------------------------------------------------------- measures

@dataclass
class Cycle:
    mean: float
    amplitude: float
    frequency: float
    change: float  # of the amplitude over the cycle before, relative


def extremes(time, values, begin, end):
    spline = CubicSpline(time, values)
    at = spline.derivative().roots(extrapolate=False)
    found = spline(at[(at > begin) & (at <= end)])
    return found.max(), found.min()


def cycle_of(time, values, window: float) -> Cycle:
    """Mean (max + min)/2 and amplitude (max - min)/2 over the last `window`, as published; the frequency by
    the upward crossings of the mean within the last three windows."""
    end = time[-1]
    high, low = extremes(time, values, end - window, end)
    before_high, before_low = extremes(time, values, end - 2 * window, end - window)
    mean, amplitude = 0.5 * (high + low), 0.5 * (high - low)
    late = time >= end - 3 * window
    spline = CubicSpline(time[late], values[late] - mean)
    crossings = spline.roots(extrapolate=False)
    up = crossings[spline.derivative()(crossings) > 0]
    frequency = (len(up) - 1) / (up[-1] - up[0]) if len(up) > 1 else float("nan")
    return Cycle(mean, amplitude, frequency, amplitude / (0.5 * (before_high - before_low)) - 1.0)


def extrapolated(values: list[float]) -> tuple[float, float | None]:
    """Richardson's limit of three values on halved cells and the order they show; the finest where they show
    none."""
    first, second = values[1] - values[0], values[2] - values[1]
    if first * second <= 0 or abs(first) <= abs(second):
        return values[2], None
    ratio = first / second
    return values[2] + second / (ratio - 1.0), float(np.log2(ratio))


def peak(time, values) -> tuple[float, float]:
    at = int(np.argmax(values))
    near = slice(max(0, at - 5), at + 6)
    spline = CubicSpline(time[near], values[near])
    roots = spline.derivative().roots(extrapolate=False)
    best = max(roots, key=lambda t: float(spline(t)))
    return float(best), float(spline(best))


# ----------------------------------------------------------------------------------------------- tables

def percent(found: float, wanted: float) -> str:
    return f"{100 * (found / wanted - 1):+.3f} %"


def table(head: list[str], body: list[list[str]]) -> str:
    def line(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in cells) + "</tr>"
    return "<table>" + line(head, "th") + "".join(line(r, "td") for r in body) + "</table>"


def steady_rows() -> list[list[str]]:
    body = []
    for family in ("turek_hron", "schaefer_turek"):
        levels = rows(VALIDATION / family / "records" / "levels.csv")
        for case in dict.fromkeys(r["case"] for r in levels):
            for wanted in published(family, case):
                value = float(wanted.get("value") or wanted.get("mean"))
                for degree in sorted({r["degree"] for r in levels if r["case"] == case}):
                    mine = [r for r in levels if r["case"] == case and r["degree"] == degree
                            and r["quantity"] == wanted["quantity"]]
                    found = [float(r["value"]) for r in sorted(mine, key=lambda r: int(r["level"]))]
                    limit, order = extrapolated(found)
                    body.append([case.upper().replace("_", "-"), NAMES[wanted["quantity"]], f"Q{degree}",
                                 f"{int(mine[-1]['unknowns']):,}", f"{value:.7g}",
                                 *(f"{v:.7g}" for v in found), percent(found[-1], value),
                                 f"{order:.2f}" if order else "–", percent(limit, value)])
    return body


STEADY_HEAD = ["case", "quantity", "elements", "unknowns", "published", "coarse", "middle", "fine",
               "fine against published", "order", "extrapolated against published"]


def unsteady_rows() -> list[list[str]]:
    body = []
    for folder, case, elements in KEPT:
        data, window = kept("turek_hron", folder), WINDOWS[case]
        if data is None:
            continue
        for wanted in published("turek_hron", case):
            name = wanted["quantity"]
            scale, unit = UNITS[name]
            found = cycle_of(data["time"], data[name], window)
            mean, amplitude, frequency = (float(wanted[k]) for k in ("mean", "amplitude", "frequency"))
            body.append([f"{case.upper()} {elements}", NAMES[name] + f" [{unit}]",
                         f"{scale * mean:.5g} ± {scale * amplitude:.5g} [{frequency:.4g} Hz]",
                         f"{scale * found.mean:.5g} ± {scale * found.amplitude:.5g} "
                         f"[{found.frequency:.4g} Hz]",
                         percent(found.mean, mean), percent(found.amplitude, amplitude),
                         percent(found.frequency, frequency), f"{100 * found.change:+.2f} %"])
    return body


UNSTEADY_HEAD = ["case", "quantity", "published (2006)", "found", "mean", "amplitude", "frequency",
                 "amplitude against the cycle before"]


def run_rows() -> list[list[str]]:
    body = []
    for family, folder, label in [("turek_hron", f, f"{c.upper()} {e}") for f, c, e in KEPT] + [
            ("schaefer_turek", "2d_3", "2D-3 Q3")]:
        data = kept(family, folder)
        if data is None:
            continue
        record = manifest(family, folder)
        numbers = record["numbers"]
        body.append([label, f"{numbers['unknowns']:,.0f}",
                     f"{1e3 * numbers['time_step']:g} ms", f"{data['time'][-1]:g} s",
                     f"{record['processor_seconds']:.0f} s", record["outcome"],
                     f"{100 * abs(data['imbalance'][-1]) / data['work'][-1]:.3f} %",
                     record["commit"][:9] + ("" if record["clean"] == "yes" else " (changed)")])
    return body


RUN_HEAD = ["case", "unknowns", "step", "to", "processor time", "outcome", "energy not accounted for, of the work",
            "commit"]


def pulsed_rows() -> list[list[str]]:
    data = kept("schaefer_turek", "2d_3")
    if data is None:
        return []
    found = {"drag": peak(data["time"], data["drag"] / 0.05), "lift": peak(data["time"], data["lift"] / 0.05),
             "pressure_difference": (data["time"][-1], data["pressure_difference"][-1])}
    return [[NAMES[w["quantity"]], w["value"], f"{found[w['quantity']][1]:.7g}",
             percent(found[w["quantity"]][1], float(w["value"])), f"{found[w['quantity']][0]:.4f} s"]
            for w in published("schaefer_turek", "2d_3")]


def cost_rows() -> list[list[str]]:
    phases = ["solve", "factorisation", "assembly", "mesh motion", "output", "set-up"]
    return [[r["variant"], f"{int(r['unknowns']):,}", r["steps"], r["processor_seconds"],
             f"{100 * float(r['tip_error']):.3f} %", f"{100 * float(r['tip_error_after_0.2s']):.3f} %",
             *(r.get(p, "–") for p in phases)]
            for r in rows(VALIDATION / "beam_in_channel" / "records" / "cost.csv")]


COST_HEAD = ["beam in a channel", "unknowns", "steps", "processor seconds", "tip error, of the largest displacement",
             "tip error from 0.2 s on, of the displacement", "solve [s]", "factorisation [s]", "assembly [s]",
             "mesh motion [s]", "output [s]", "set-up [s]"]


# ---------------------------------------------------------------------------------------------- figures

def draw_unsteady():
    cases = [(f, c, e) for f, c, e in KEPT if kept("turek_hron", f) is not None]
    if not cases:
        return None
    figure, axes = plt.subplots(len(cases), 2, figsize=(style.WIDTH, 1.9 * len(cases)), squeeze=False,
                                width_ratios=[2, 1], layout="constrained")
    for (folder, case, elements), (left, right) in zip(cases, axes):
        data, window = kept("turek_hron", folder), WINDOWS[case]
        name = "uy" if "uy" in data else "lift"
        scale, unit = UNITS[name]
        wanted = next(w for w in published("turek_hron", case) if w["quantity"] == name)
        mean, amplitude = scale * float(wanted["mean"]), scale * float(wanted["amplitude"])
        for ax in (left, right):
            ax.plot(data["time"], scale * data[name], color=FOUND, linewidth=0.8)
            for line in (mean - amplitude, mean + amplitude):
                ax.axhline(line, color=PUBLISHED, linewidth=0.8, dashes=(4, 2))
            ax.set_xlabel("t [s]")
        left.set(title=f"{case.upper()}, {elements}: {NAMES[name]}; dashed: published extremes", ylabel=unit)
        right.set(xlim=(data["time"][-1] - 1.2 * window, data["time"][-1]), title="the end")
    return figure


def draw_orders():
    figure, axes = plt.subplots(1, 2, figsize=(style.WIDTH, 3.2), layout="constrained")
    levels = rows(VALIDATION / "schaefer_turek" / "records" / "levels.csv")
    if not levels:
        return None
    for wanted, mark in zip(published("schaefer_turek", "2d_1"), "osD"):
        for degree, colour in (("2", style.RUNS["paper"]), ("3", style.RUNS["recommended"])):
            mine = sorted((r for r in levels if r["degree"] == degree and r["quantity"] == wanted["quantity"]),
                          key=lambda r: int(r["level"]))
            error = [abs(float(r["value"]) / float(wanted["value"]) - 1) for r in mine]
            axes[0].loglog([int(r["unknowns"]) for r in mine], error, mark + "-", color=colour, markersize=4,
                           label=f"{NAMES[wanted['quantity']]}, Q{degree}")
    axes[0].axhline(1e-4, color="#777777", linewidth=0.8, dashes=(4, 2))
    axes[0].set(xlabel="unknowns", ylabel="relative error", title="2D-1 against the published digits")
    axes[0].legend(fontsize=6.5)
    data = kept("schaefer_turek", "2d_3")
    if data is not None:
        axes[1].plot(data["time"], data["drag"] / 0.05, color=FOUND, label="drag coefficient")
        axes[1].plot(data["time"], data["lift"] / 0.05, color=style.RUNS["paper"], label="lift coefficient")
        for wanted in published("schaefer_turek", "2d_3")[:2]:
            axes[1].axhline(float(wanted["value"]), color=PUBLISHED, linewidth=0.8, dashes=(4, 2))
        axes[1].set(xlabel="t [s]", title="2D-3; dashed: published maxima")
        axes[1].legend(fontsize=7)
    return figure


def draw_cost():
    cost = rows(VALIDATION / "beam_in_channel" / "records" / "cost.csv")
    if not cost:
        return None
    phases = ["solve", "factorisation", "assembly", "mesh motion", "output", "set-up"]
    figure, axes = plt.subplots(figsize=(style.WIDTH, 0.42 * len(cost) + 1.0), layout="constrained")
    left = np.zeros(len(cost))
    for phase, colour in zip(phases, ["#1a1a1a", "#56b4e9", "#009e73", "#e69f00", "#cc79a7", "#999999"]):
        width = np.array([float(r.get(phase) or 0) / float(r["processor_seconds"]) for r in cost])
        axes.barh(range(len(cost)), 100 * width, left=100 * left, color=colour, label=phase)
        left += width
    axes.set_yticks(range(len(cost)), [f"{r['variant']}: {float(r['processor_seconds']):.2g} s" for r in cost])
    axes.invert_yaxis()
    axes.set(xlabel="part of the processor time [%]", title="Beam in a channel: where the time goes")
    axes.legend(ncols=6, fontsize=7, loc="upper center", bbox_to_anchor=(0.4, -0.22))
    return figure


# ------------------------------------------------------------------------------------------------- page

STYLE = """body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#1a1a1a}
table{border-collapse:collapse;font-size:12.5px;margin:1em 0}td,th{border-bottom:1px solid #ddd;padding:.25em .6em;
text-align:left}img{max-width:100%}"""


def picture(name: str, alternative: str) -> str:
    file = FIGURES / name
    if not file.is_file():
        return ""
    data = base64.b64encode(file.read_bytes()).decode()
    return f'<img alt="{html.escape(alternative)}" src="data:image/png;base64,{data}">'


def page() -> str:
    parts = ["<h1>The finite element reference against published values</h1>",
             "<p>Limits of the steady cases: 0.5 % (2D-1's drag 0.01 %); of the unsteady ones 2 %. "
             "Every value comes from a kept record with its manifest.</p>",
             "<h2>Steady</h2>", table(STEADY_HEAD, steady_rows()),
             picture("reference_orders.png", "Errors of the 2D-1 coefficients over unknowns; coefficients of 2D-3 "
                     "over time"),
             "<h2>A cylinder in a pulse, 2D-3</h2>",
             table(["quantity", "published", "found", "difference", "at"], pulsed_rows()),
             "<h2>Unsteady</h2>", table(UNSTEADY_HEAD, unsteady_rows()),
             picture("reference_unsteady.png", "Histories of the unsteady benchmarks with the published extremes"),
             "<h2>The runs</h2>", table(RUN_HEAD, run_rows()),
             "<h2>Cost</h2>", table(COST_HEAD, cost_rows()),
             picture("reference_cost.png", "Parts of the processor time by phase")]
    return f"<!doctype html><meta charset=utf-8><title>Reference</title><style>{STYLE}</style>" + "".join(parts)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "reference_chapter.html")
    parser.add_argument("--keep", nargs=3, metavar=("RUN", "FAMILY", "CASE"))
    arguments = parser.parse_args()
    if arguments.keep:
        keep(Path(arguments.keep[0]), arguments.keep[1], arguments.keep[2])
        return 0
    drawn = {"orders": draw_orders(), "unsteady": draw_unsteady(), "cost": draw_cost()}
    for name, figure in drawn.items():
        if figure is not None:
            figure.savefig(FIGURES / f"reference_{name}.png", dpi=110)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(page())
    for head, body in ((STEADY_HEAD, steady_rows()), (UNSTEADY_HEAD, unsteady_rows()), (RUN_HEAD, run_rows()),
                       (COST_HEAD, cost_rows())):
        for line in [head, *body]:
            print(" | ".join(line))
        print()
    print(arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
