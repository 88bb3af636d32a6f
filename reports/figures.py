"""The figures of a comparison. Each function draws one, or returns None where the records lack its data.

A figure is a matplotlib Figure with a sentence that says what it shows (for readers who do not see it) and a
caption.
"""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

import style
from record import Columns, Record, Snapshot


SOLID = "#e8e4df"  # light: velocities near a body are low, hence dark


@dataclass
class Picture:
    name: str
    figure: Figure
    alternative: str
    caption: str


@dataclass
class Sides:
    """What every figure is drawn from."""

    reference: Record
    runs: list[Record]
    channel: tuple[float, float, float, float]  # x0, y0, x1, y1 in m
    spacing: dict[str, float]  # m, by run; 0 if unknown
    comparison: dict
    probes: dict[str, list[str]]  # names of probes by kind

    def colour(self, run: Record) -> str:
        return style.colour(run.label, self.runs.index(run))

    @property
    def judged_at(self) -> list[float]:
        return self.comparison["judged_at"]


def _legend_above(figure: Figure, handles, labels) -> None:
    """One legend in a strip of 0.3 inches above all panels."""
    strip = 0.3 / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - strip))
    figure.legend(handles, labels, loc="upper right", ncols=max(1, len(labels)), borderaxespad=0.3)


def seconds(time: float) -> str:
    return f"t = {time:g} s"


# ----------------------------------------------------------------------------- fields (the paper's Fig. 7)


def solid_flag(snapshot: Snapshot) -> np.ndarray:
    """True where a particle is solid: role 0 of the particle solver."""
    if "role" not in snapshot.fields:
        return np.zeros(len(snapshot.positions), dtype=bool)
    return snapshot.fields["role"] < 0.5


def _triangles(cells: np.ndarray) -> np.ndarray:
    if cells.shape[1] == 3:
        return cells
    return np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])


def _draw_mesh(axes, snapshot: Snapshot, outline: Columns | None, limits):
    x, y = snapshot.positions[:, 0], snapshot.positions[:, 1]
    artist = axes.tripcolor(
        x, y, _triangles(snapshot.cells), snapshot.fields["velocity"][:, 0], shading="gouraud",
        vmin=limits[0], vmax=limits[1], cmap="viridis", rasterized=True,
    )
    if outline is not None:
        axes.add_patch(Polygon(np.column_stack([outline["x"], outline["y"]]), color=SOLID, lw=0))
    return artist


def _draw_particles(axes, snapshot: Snapshot, spacing: float, limits) -> None:
    solid = solid_flag(snapshot)
    x, y = snapshot.positions[:, 0], snapshot.positions[:, 1]
    # Drawn in metres, wider than the spacing: no white between fluid particles that stand in disorder.
    for chosen, width, look in (
        (~solid, 1.9, {"array": snapshot.fields["velocity"][~solid, 0], "cmap": "viridis", "clim": limits}),
        (solid, 1.4, {"facecolor": SOLID}),
    ):
        size = np.full(int(chosen.sum()), width * spacing)
        axes.add_collection(EllipseCollection(
            size, size, np.zeros_like(size), units="xy", offsets=np.column_stack([x[chosen], y[chosen]]),
            transOffset=axes.transData, linewidths=0, rasterized=True, **look,
        ))


def field(sides: Sides, time: float = 1.0) -> Picture | None:
    panels = [(r, s) for r in (*sides.runs, sides.reference) if (s := r.snapshot(time)) is not None]
    if sides.reference.snapshot(time) is None or len(panels) < 2:
        return None
    values = [s.fields["velocity"][:, 0] for _, s in panels]
    # One scale for all: the reference's range, rounded outward; a wild run saturates instead of
    # hiding everyone else.
    low, high = float(values[-1].min()), float(values[-1].max())
    limits = (np.floor(10 * low) / 10, np.ceil(10 * high) / 10)
    x0, y0, x1, y1 = sides.channel
    height = 0.85 * style.WIDTH * (y1 - y0) / (x1 - x0) + 0.35
    figure, grid = plt.subplots(
        len(panels), 1, figsize=(style.WIDTH, len(panels) * height), sharex=True, squeeze=False,
        layout="constrained",
    )
    artist = None
    for axes, (record, snapshot) in zip(grid.flat, panels):
        axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", ylabel="y [m]")
        axes.grid(False)
        if snapshot.cells is not None:
            outline = next((record.table(n, time) for n in sides.probes["outline"]), None)
            artist = _draw_mesh(axes, snapshot, outline, limits)
        else:
            _draw_particles(axes, snapshot, sides.spacing.get(record.label) or 0.004, limits)
        axes.set_title(title_of(record, sides))
    grid[-1, 0].set_xlabel("x [m]")
    figure.colorbar(artist, ax=grid, label="streamwise velocity [m/s]", extend="both", shrink=0.8, aspect=30,
                    pad=0.01)
    names = ", ".join(title_of(r, sides) for r, _ in panels)
    return Picture(
        "field", figure,
        f"Streamwise velocity in the channel at {seconds(time)}, one panel each for {names}, on one colour "
        f"scale from {limits[0]:g} to {limits[1]:g} m/s; solids light.",
        f"Streamwise velocity at {seconds(time)}, counterpart of the paper's Fig. 7. One colour scale, the "
        "reference's range; arrows at its ends mark what lies beyond. Solids light.",
    )


def frame(axes, sides: Sides, curves: dict[str, np.ndarray]) -> None:
    """Sets the height of the axes by the reference and the runs that finished (by label): one
    that blew up leaves the picture instead of flattening everyone else."""
    whole = [c for label, c in curves.items()
             if label == "reference" or any(r.label == label and r.finished for r in sides.runs)]
    values = np.concatenate(whole or list(curves.values()))
    margin = 0.1 * (values.max() - values.min()) or 0.01
    axes.set_ylim(values.min() - margin, values.max() + margin)


def title_of(record: Record, sides: Sides) -> str:
    return "finite element reference" if record is sides.reference else f"particles, {record.label}"


# -------------------------------------------------------------- beam and profiles (the paper's Fig. 8)


def _draw_beams(axes, sides: Sides, time: float, box) -> None:
    for name in sides.probes["outline"]:
        outline = sides.reference.table(name, time)
        if outline is not None:
            body = np.column_stack([outline["x"], outline["y"]])
            axes.add_patch(Polygon(body, closed=False, fc="#e8e8e8", ec=style.REFERENCE, lw=1.2))
    for run in reversed(sides.runs):
        snapshot = run.snapshot(time)
        main = run is sides.runs[0]
        if snapshot is not None and solid_flag(snapshot).any():
            solid = solid_flag(snapshot)
            axes.scatter(
                snapshot.positions[solid, 0], snapshot.positions[solid, 1], s=5 if main else 4,
                facecolors=sides.colour(run) if main else "none", edgecolors=sides.colour(run),
                linewidths=0 if main else 0.5, zorder=3 if main else 2,
            )
            continue
        for name in sides.probes["outline"]:
            outline = run.table(name, time)
            if outline is not None:
                axes.plot(outline["x"], outline["y"], color=sides.colour(run), ls=style.dashes(run.label))
    axes.set(xlim=box[:2], ylim=box[2:], aspect="equal")


def _draw_profiles(axes, sides: Sides, name: str, time: float) -> None:
    for run in reversed(sides.runs):
        table = run.table(name, time)
        if table is not None:
            axes.plot(table["velocity_x"], table["y"], color=sides.colour(run), ls=style.dashes(run.label),
                      label=f"particles, {run.label}")
    reference = sides.reference.table(name, time)
    if reference is not None:
        axes.plot(reference["velocity_x"], reference["y"], color=style.REFERENCE, ls=(0, (5, 3)), lw=1.2,
                  label="reference", zorder=4)


def _beam_box(sides: Sides) -> tuple[float, float, float, float]:
    """A window around every place the bodies reach (m: x0, x1, y0, y1), but for runs beyond twice the
    reference's reach: they leave the picture instead of shrinking everyone else."""
    def reach(record: Record) -> np.ndarray:
        corners = []
        for name in sides.probes["outline"]:
            for time in record.table_times(name):
                table = record.table(name, time)
                corners += [np.column_stack([table[a], table[b]]) for a, b in
                            (("x", "y"), ("reference_x", "reference_y"))]
        points = np.vstack(corners) if corners else np.full((1, 2), np.nan)
        return np.array([points[:, 0].min(), points[:, 0].max(), points[:, 1].max()])

    own = reach(sides.reference)
    limit = np.array([own[0] - (own[1] - own[0]), own[1] + (own[1] - own[0]), 1.3 * own[2]])
    others = np.vstack([own, *(reach(run) for run in sides.runs)])
    low = max(limit[0], np.nanmin(others[:, 0]))
    high, top = min(limit[1], np.nanmax(others[:, 1])), min(limit[2], np.nanmax(others[:, 2]))
    margin = 0.12 * (top - sides.channel[1])
    return low - margin, high + margin, sides.channel[1], top + margin


def beams_and_profiles(sides: Sides) -> Picture | None:
    times = [t for t in sides.judged_at if any(sides.reference.table(n, t) for n in sides.probes["profile"])]
    if not times or not sides.probes["outline"]:
        return None
    profile = sides.probes["profile"][0]
    box = _beam_box(sides)
    fastest = max(sides.reference.table(profile, t)["velocity_x"].max() for t in times)
    slowest = min(sides.reference.table(profile, t)["velocity_x"].min() for t in times)
    columns = 2
    rows = (len(times) + 1) // columns
    figure, grid = plt.subplots(
        rows, 2 * columns, figsize=(style.WIDTH * 1.1, 2.5 * rows + 0.3), layout="constrained",
        width_ratios=[0.8, 1.0] * columns, squeeze=False,
    )
    for axes in grid.flat[2 * len(times):]:
        axes.set_axis_off()
    for k, time in enumerate(times):
        # Down the columns, as the paper orders its panels.
        row, column = k % rows, k // rows
        left, right = grid[row, 2 * column], grid[row, 2 * column + 1]
        _draw_beams(left, sides, time, box)
        _draw_profiles(right, sides, profile, time)
        left.set_title(f"{chr(97 + k)}) {seconds(time)}")
        right.set(xlim=(min(0.0, 1.1 * slowest) - 0.02, 1.12 * fastest), ylim=(sides.channel[1], sides.channel[3]))
        left.set(xlabel="x [m]" if row == rows - 1 else "", ylabel="y [m]")
        right.set(xlabel="streamwise velocity [m/s]" if row == rows - 1 else "")
        left.xaxis.set_major_locator(MaxNLocator(2))
        right.xaxis.set_major_locator(MaxNLocator(4))
    handles, labels = grid[0, 1].get_legend_handles_labels()
    _legend_above(figure, handles[::-1], labels[::-1])
    place = sides.reference.table(profile, times[0])["x"][0]
    return Picture(
        "beams_and_profiles", figure,
        f"At each of {len(times)} times: left, the deformed body of the reference and the solid particles; "
        f"right, profiles of streamwise velocity at x = {place:g} m by all of them.",
        f"Bodies (left: reference grey with black outline, solid particles in colour) and velocity profiles at "
        f"x = {place:g} m (right), counterpart of the paper's Fig. 8. A colour that ends before the last time "
        "belongs to a run that stopped.",
    )


# ------------------------------------------------------------------------------------------- histories


def displacement(sides: Sides) -> Picture | None:
    if not sides.probes["displacement"]:
        return None
    name = sides.probes["displacement"][0]
    reference = sides.reference.series(name)
    if reference is None:
        return None
    figure, (top, middle, bottom) = plt.subplots(
        3, 1, figsize=(style.WIDTH, 6.2), sharex=True, height_ratios=[2, 1, 1.3], layout="constrained"
    )
    length = np.hypot(reference["displacement_x"], reference["displacement_y"])
    curves = {c: {"reference": 1e3 * reference[c]} for c in ("displacement_x", "displacement_y")}
    for run in sides.runs:
        series = run.series(name)
        if series is None:
            continue
        look = {"color": sides.colour(run), "ls": style.dashes(run.label), "label": f"particles, {run.label}"}
        top.plot(series["time"], 1e3 * series["displacement_x"], **look)
        middle.plot(series["time"], 1e3 * series["displacement_y"], **look)
        for component in curves:
            curves[component][run.label] = 1e3 * series[component]
        common = reference["time"][(reference["time"] <= series["time"][-1]) & (length > 0.02 * length.max())]
        scale = np.interp(common, reference["time"], length)
        apart = np.hypot(*(
            np.interp(common, series["time"], series[c]) - np.interp(common, reference["time"], reference[c])
            for c in ("displacement_x", "displacement_y")
        ))
        bottom.plot(common, 100 * apart / scale, **look)
    dark = {"color": style.REFERENCE, "ls": (0, (5, 3)), "label": "reference"}
    top.plot(reference["time"], 1e3 * reference["displacement_x"], **dark)
    middle.plot(reference["time"], 1e3 * reference["displacement_y"], **dark)
    judged = [(m["time"], m["limit"]) for r in sides.comparison["runs"] for m in r["measurements"]
              if m["measure"] == "displacement_difference" and m["limit"] is not None]
    if judged:
        bottom.plot(*zip(*((t, 100 * limit) for t, limit in judged)), "v", color="#555", ms=5,
                    label="limit, where judged")
        bottom.set_ylim(0, max(8.0, 250 * judged[0][1]))
    frame(top, sides, curves["displacement_x"])
    frame(middle, sides, curves["displacement_y"])
    top.set(ylabel="x [mm]", title=f"Displacement of probe '{name}'")
    middle.set(ylabel="y [mm]")
    bottom.set(ylabel="difference [%]", xlabel="time [s]", title="Length of the difference over the reference's "
               "displacement at the same time")
    top.legend(loc="lower right")
    bottom.legend(loc="upper right")
    return Picture(
        "displacement", figure,
        f"Displacement of probe {name} over time, x above and y in the middle, by the reference and the "
        "particle runs; below, the relative difference with its limit.",
        "Displacement history. The lowest panel starts where the reference has moved by 2 % of its largest "
        "displacement; its axis is cut, so that a run far off leaves the picture.",
    )


def _running_mean(time: np.ndarray, value: np.ndarray, window: float) -> tuple[np.ndarray, np.ndarray]:
    """Means over `window` (s), at the times whose window lies within the record."""
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (value[1:] + value[:-1]) * np.diff(time))])
    inside = time[(time >= time[0] + window / 2) & (time <= time[-1] - window / 2)]
    ends = (np.interp(inside + s * window / 2, time, integral) for s in (1, -1))
    return inside, (next(ends) - next(ends)) / window


def force(sides: Sides) -> Picture | None:
    if not sides.probes["force"]:
        return None
    name, window = sides.probes["force"][0], sides.comparison["force_window"]
    reference = sides.reference.series(name)
    if reference is None:
        return None
    figure, panels = plt.subplots(2, 1, figsize=(style.WIDTH, 5.0), sharex=True, layout="constrained")
    for axes, component, text in zip(panels, ("force_x", "force_y"), ("x (drag)", "y (lift)")):
        for run in sides.runs:
            series = run.series(name)
            if series is None or len(series) < 3:
                continue
            axes.plot(series["time"], series[component], color=sides.colour(run), lw=0.4, alpha=0.3)
            if series["time"][-1] - series["time"][0] > window:
                axes.plot(*_running_mean(series["time"], series[component], window), lw=1.5,
                          color=sides.colour(run), ls=style.dashes(run.label), label=f"particles, {run.label}")
        axes.plot(reference["time"], reference[component], color="#999", lw=0.6)
        axes.plot(*_running_mean(reference["time"], reference[component], window), color=style.REFERENCE,
                  ls=(0, (5, 3)), label="reference")
        span = reference[component].max() - reference[component].min()
        axes.set(ylabel=f"{text} [N/m]",
                 ylim=(reference[component].min() - 0.6 * span, reference[component].max() + 0.6 * span))
    panels[0].set_title(f"Force of the fluid on the body, probe '{name}'")
    panels[1].set_xlabel("time [s]")
    panels[0].legend(loc="lower right")
    return Picture(
        "force", figure,
        "Force of the fluid on the body per metre of depth over time, x above and y below, by the reference "
        "and the particle runs: faint lines instantaneous, strong lines averaged.",
        f"Force on the body per metre of depth. Strong lines: mean over {1e3 * window:g} ms, which is what the "
        "table compares; faint lines: instantaneous.",
    )


# --------------------------------------------------------------------------------------------- ledgers


LEDGERS = (
    ("ledger_mass", "excess_outflow", "Outflow minus inflow so far", "% of the channel"),
    ("ledger_mass", "particles", "Number of particles since the start", "%"),
    ("ledger_solid", "area_ratio", "Area of the solids since the start", "%"),
    ("ledger_divergence", "rms_divergence", "Remaining divergence of velocity, rms", "1/s"),
    ("ledger_energy", "kinetic_fluid", "Kinetic energy of the fluid", "J/m"),
    ("ledger_energy", "elastic", "Elastic energy of the solids", "J/m"),
)


def _as_drawn(column: str, values: np.ndarray, area: float) -> np.ndarray:
    if column == "excess_outflow":
        return 100 * values / area
    if column in ("particles", "area_ratio"):
        return 100 * (values / values[0] - 1)
    return values


def _draw_ledger(axes, sides: Sides, ledger: str, column: str) -> None:
    x0, y0, x1, y1 = sides.channel
    curves = {}
    for record in (*sides.runs, sides.reference):
        series = record.series(ledger)
        if series is None or column not in series:
            continue
        look = {"color": style.REFERENCE, "ls": (0, (5, 3))}
        if record is not sides.reference:
            look = {"color": sides.colour(record), "ls": style.dashes(record.label)}
        curves[record.label] = _as_drawn(column, series[column], (x1 - x0) * (y1 - y0))
        axes.plot(series["time"], curves[record.label], lw=1.0, label=title_of(record, sides), **look)
    if curves:
        frame(axes, sides, curves)


def ledgers(sides: Sides) -> Picture | None:
    figure, grid = plt.subplots(3, 2, figsize=(style.WIDTH, 7.2), sharex=True, layout="constrained")
    for axes, (ledger, column, title, unit) in zip(grid.flat, LEDGERS):
        _draw_ledger(axes, sides, ledger, column)
        axes.set(title=title, ylabel=unit)
    for axes in grid[-1]:
        axes.set_xlabel("time [s]")
    if not any(axes.lines for axes in grid.flat):
        plt.close(figure)
        return None
    handles, labels = grid[0, 0].get_legend_handles_labels()
    _legend_above(figure, handles, labels)
    return Picture(
        "ledgers", figure,
        "Six histories: outflow minus inflow, number of particles, area of the solids, remaining divergence, "
        "kinetic energy of the fluid, elastic energy of the solids.",
        "What both methods should keep. A line is missing where a solver keeps no such book; a run that stopped "
        "may leave its panel.",
    )


# ------------------------------------------------------------------------------------------------ cost


def cost(sides: Sides) -> Picture | None:
    bars = [(title_of(r, sides), r.cost) for r in (sides.reference, *sides.runs) if r.cost]
    if not bars:
        return None
    figure, grid = plt.subplots(
        len(bars), 1, figsize=(style.WIDTH, 0.6 + sum(0.5 + 0.19 * len(c) for _, c in bars)),
        height_ratios=[0.5 + 0.19 * len(c) for _, c in bars], squeeze=False, layout="constrained",
    )
    for axes, (name, phases) in zip(grid[:, 0], bars):
        total = sum(s for _, s in phases) or 1.0
        labels = [phase for phase, _ in phases]
        artist = axes.barh(labels, [s for _, s in phases], color="#7a8ea3", height=0.7)
        axes.bar_label(artist, [f"{s:.3g} s · {100 * s / total:.0f} %" for _, s in phases], padding=3, fontsize=8)
        axes.invert_yaxis()
        axes.grid(axis="y", visible=False)
        axes.set_xlim(0, 1.25 * max(s for _, s in phases))
        axes.set_title(f"{name}: {total:.3g} s in all phases")
    grid[-1, 0].set_xlabel("seconds")
    return Picture(
        "cost", figure, "Bars: seconds spent in each phase of the step, for each solver.",
        "Where the wall time goes, by each solver's own clocks.",
    )


ALL = (beams_and_profiles, field, displacement, force, ledgers, cost)
