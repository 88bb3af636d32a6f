"""What a check of a verification.toml measures: a record against an exact solution or published values.

Every kind is one function of (record, scene, check, case folder); it returns a Finding. A record that lacks what is
asked for raises Missing, a scene or check that does not fit raises SceneMismatch.
"""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import exact
from scene import Scene, SceneMismatch

from record import Record, quantity  # noqa: I001  (scene.py made the reader known)


class Missing(Exception):
    """The record lacks what a check wants, or the run did not come so far."""


@dataclass
class Curve:
    """One line of a picture: what was found over what is exact, at the places of `axis`."""

    label: str
    axis: list
    found: list
    exact: list


@dataclass
class Finding:
    """error: what is judged and what an order is taken of. Further figures are shown beside it."""

    error: float
    figures: dict = field(default_factory=dict)
    curves: list = field(default_factory=list)
    axes: tuple = ("", "")  # words for the picture: along, up


FLUID = 1.0  # Role::fluid of sph/particles.hpp


def flow_of(check: dict, scene: Scene):
    return exact.solution(check["exact"], scene, check.get("parameters", {}))


def times_of(check: dict, available: list) -> list:
    """The times that a check looks at, of those that the record has: `from` and `until` bound them."""
    begin = quantity(check["from"]) if "from" in check else -math.inf
    end = quantity(check["until"]) if "until" in check else math.inf
    chosen = [t for t in available if begin - 1e-9 <= t <= end + 1e-9]
    if not chosen:
        raise Missing(f"no data between {check.get('from', 'the start')} and {check.get('until', 'the end')}")
    return chosen


def scaled(errors: np.ndarray, size: float, norm: str) -> float:
    """rms or max of the errors' lengths (rows) over `size`."""
    length = np.linalg.norm(np.atleast_2d(errors), axis=1)
    value = math.sqrt(np.mean(length**2)) if norm == "rms" else float(np.max(length))
    return value / size


def size_of(check: dict, exact_values: np.ndarray) -> float:
    """What errors are divided by: a quantity, or "peak", the largest exact value there is."""
    scale = check.get("scale", "peak")
    if scale != "peak":
        return quantity(scale)
    return float(np.max(np.linalg.norm(exact_values, axis=-1)))


def positions(table, dimension: int) -> np.ndarray:
    columns = [table[axis] for axis in "xyz"[:dimension]]
    return np.column_stack(columns + [np.zeros(len(table))] * (3 - dimension))


def velocities(table, dimension: int) -> np.ndarray:
    columns = [table[f"velocity_{axis}"] for axis in "xyz"[:dimension]]
    return np.column_stack(columns + [np.zeros(len(table))] * (3 - dimension))


# ------------------------------------------------------------------------------------- against exact solutions


def profile(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """A velocity_along probe against an exact velocity; every component counts. All its times together, or, with
    average = true (for a steady flow, whose noise is not its error), the mean of them."""
    flow, name = flow_of(check, scene), check["probe"]
    found, wanted, places, curves = [], [], [], []
    times = times_of(check, record.table_times(name))
    for t in times:
        table = record.table(name, t)
        places.append(positions(table, scene.dimension))
        found.append(velocities(table, scene.dimension))
        wanted.append(flow.velocity(places[-1], t))
    size = size_of(check, np.array(wanted))
    spread = float(np.sqrt(np.mean(np.var(found, axis=0)))) / size
    if check.get("average", False):
        found, wanted, times = [np.mean(found, axis=0)], [np.mean(wanted, axis=0)], times[-1:]
    component = "xyz".index(check.get("component", "x"))
    along = int(np.argmax(np.ptp(places[0], axis=0)))
    for k, t in enumerate(times):
        curves.append(Curve(f"t = {t:.4g} s", places[k][:, along].tolist(), found[k][:, component].tolist(),
                            wanted[k][:, component].tolist()))
    difference = [f - w for f, w in zip(found, wanted)]
    each = {f"t={t:.4g}": scaled(d, size, check.get("norm", "rms")) for t, d in zip(times, difference)}
    largest = scaled(np.vstack(difference), size, "max")
    figures = {"largest": largest, "spread over time": spread, **each}
    return Finding(scaled(np.vstack(difference), size, check.get("norm", "rms")), figures, curves,
                   (f"{'xyz'[along]} [m]", f"velocity {'xyz'[component]} [m/s]"))


def particles(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """Velocity of every fluid particle against the exact one at its place: at each time the L2 norm of the
    difference over that of the exact field; the largest of the times."""
    flow = flow_of(check, scene)
    each, l1 = {}, 0.0
    for t in times_of(check, record.snapshot_times()):
        snapshot = record.snapshot(t)
        fluid = snapshot.fields["role"] == FLUID
        found, places = snapshot.fields["velocity"][fluid], snapshot.positions[fluid]
        wanted = flow.velocity(places, t)
        each[f"t={t:.4g}"] = float(np.linalg.norm(found - wanted) / np.linalg.norm(wanted))
        speed = np.linalg.norm(wanted, axis=1)
        l1 = float(np.sum(np.abs(np.linalg.norm(found, axis=1) - speed)) / np.sum(speed))
    return Finding(max(each.values()), {**each, "L1 of the speed at the last time": l1})


def energy(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """Kinetic energy of the fluid against the exact one at the same time: the largest relative difference."""
    flow, ledger = flow_of(check, scene), record.series("ledger_energy")
    if ledger is None:
        raise Missing("no ledger of energy")
    time = np.array(times_of(check, list(ledger["time"])))
    found = np.interp(time, ledger["time"], ledger["kinetic_fluid"])
    wanted = flow.kinetic_energy(time)
    relative = found / wanted - 1.0
    some = np.unique(np.linspace(0, len(time) - 1, 61).astype(int))
    curve = Curve("kinetic energy", time[some].tolist(), found[some].tolist(), wanted[some].tolist())
    return Finding(float(np.max(np.abs(relative))), {"at the end": float(relative[-1])}, [curve],
                   ("t [s]", "kinetic energy [J]"))


def flow_rate(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """Mean velocity of the fluid particles along x (flow over area) against the exact one: largest difference
    over the largest exact value."""
    flow = flow_of(check, scene)
    times, found, wanted = times_of(check, record.snapshot_times()), [], []
    for t in times:
        snapshot = record.snapshot(t)
        fluid = snapshot.fields["role"] == FLUID
        found.append(float(np.mean(snapshot.fields["velocity"][fluid, 0])))
        wanted.append(flow.mean_velocity(t))
    size = np.max(np.abs(wanted))
    error = float(np.max(np.abs(np.array(found) - wanted)) / size)
    return Finding(error, {"at the last time": (found[-1] - wanted[-1]) / size},
                   [Curve("mean velocity", times, found, wanted)], ("t [s]", "mean velocity [m/s]"))


def pressure(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """Pressure of the fluid particles against the exact one, both without their mean; rms over `scale`, of the
    mean over the times at every place (one step's pressure is noise around its mean) if `mean` is true."""
    flow, errors = flow_of(check, scene), []
    curves = []
    for t in times_of(check, record.snapshot_times()):
        snapshot = record.snapshot(t)
        fluid = snapshot.fields["role"] == FLUID
        places, found = snapshot.positions[fluid], snapshot.fields["pressure"][fluid]
        wanted = flow.pressure(places, t)
        found, wanted = found - np.mean(found), wanted - np.mean(wanted)
        size = np.ptp(wanted) if check.get("scale", "peak") == "peak" else quantity(check["scale"])
        errors.append(math.sqrt(np.mean((found - wanted) ** 2)) / size)
        some = np.argsort(places[:, 1])[:: max(1, len(places) // 400)]
        curves = [Curve(f"t = {t:.4g} s", places[some, 1].tolist(), found[some].tolist(), wanted[some].tolist())]
    return Finding(max(errors), {}, curves, ("y [m]", "pressure without its mean [Pa]"))


def rest(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """Largest speed of any fluid particle at any snapshot after the start, over `scale`."""
    speeds, times = [], times_of(check, record.snapshot_times())
    for t in times:
        snapshot = record.snapshot(t)
        fluid = snapshot.fields["role"] == FLUID
        speeds.append(float(np.max(np.linalg.norm(snapshot.fields["velocity"][fluid], axis=1))))
    size = quantity(check["scale"])
    curve = Curve("largest speed", times, speeds, [0.0] * len(times))
    return Finding(max(speeds) / size, {"at the end": speeds[-1] / size}, [curve],
                   ("t [s]", "largest speed [m/s]"))


def steps(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """How many of `wanted` steps are missing, as a fraction: 0 if the run took as many or more."""
    taken = record.manifest["numbers"]["steps"]
    return Finding(max(0.0, 1.0 - taken / check["wanted"]), {"steps": taken})


# ------------------------------------------------------------------------------------ against published values


def read_literature(file: Path) -> dict:
    """Columns of a CSV file whose first lines, from '#', say where the values come from; empty cells are nan."""
    lines = [line for line in file.read_text().splitlines() if line.strip() and not line.startswith("#")]
    names = [name.strip() for name in lines[0].split(",")]
    rows = [[float(cell) if cell.strip() else math.nan for cell in line.split(",")] for line in lines[1:]]
    return dict(zip(names, np.array(rows).T))


def literature(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """A velocity_along probe, averaged over its times from `from` on, against a column of a published table."""
    published, name = read_literature(folder / "literature" / check["file"]), check["probe"]
    axis, component = check["along"], check["component"]
    times = times_of(check, record.table_times(name))
    tables = [record.table(name, t) for t in times]
    mean = np.mean([table[f"velocity_{component}"] for table in tables], axis=0)
    place, wanted = published[axis], published[check["column"]]
    known = ~np.isnan(wanted) & (place > 0.0) & (place < 1.0)
    found = np.interp(place[known], tables[0][axis], mean)
    size = quantity(check["scale"])
    difference = found - wanted[known]
    last = tables[-1][f"velocity_{component}"]
    unrest = float(np.sqrt(np.mean((last - tables[0][f"velocity_{component}"]) ** 2)) / size)
    curve = Curve(f"mean of {len(times)} times from {times[0]:.4g} s", tables[0][axis].tolist(), mean.tolist(), [])
    points = Curve("published", place[known].tolist(), [], wanted[known].tolist())
    return Finding(scaled(difference[:, None], size, check.get("norm", "rms")),
                   {"largest": scaled(difference[:, None], size, "max"), "change while averaged": unrest},
                   [curve, points], (f"{axis} [m]", f"velocity {component} [m/s]"))


def mean_value(record: Record, scene: Scene, check: dict, folder: Path) -> Finding:
    """Mean of a series' column (less the column `minus`) from `from` on, times `factor`, against `value`: relative
    to `scale`, the value itself unless given."""
    series = record.series(check["probe"])
    if series is None:
        raise Missing(f"no series '{check['probe']}'")
    time = series["time"]
    begin = quantity(check["from"])
    late = time >= begin - 1e-9
    if not np.any(late):
        raise Missing(f"the run did not come to {check['from']}")
    values = series[check["column"]] - (series[check["minus"]] if "minus" in check else 0.0)
    values = check.get("factor", 1.0) * values
    # Steps differ in length: weights are the intervals that they end.
    weight = np.diff(time, prepend=time[0])[late]
    weight = weight if np.sum(weight) > 0.0 else np.ones_like(weight)
    found = float(np.average(values[late], weights=weight))
    half = np.cumsum(weight) <= 0.5 * np.sum(weight)
    drift = float(np.average(values[late][~half], weights=weight[~half]) - found) if np.any(~half) else 0.0
    size = check.get("scale", abs(check["value"]))
    block = max(1, len(time) // 200)
    whole = len(time) // block * block
    curve = Curve(check["column"], time[:whole].reshape(-1, block).mean(1).tolist(),
                  values[:whole].reshape(-1, block).mean(1).tolist(), [check["value"]] * (whole // block))
    return Finding(abs(found - check["value"]) / size,
                   {"value": found, "published": check["value"], "drift while averaged": drift / size,
                    "standard deviation of a step": float(np.std(values[late])) / size}, [curve],
                   ("t [s]", check.get("label", check["column"])))


KINDS = {"profile": profile, "particles": particles, "energy": energy, "flow_rate": flow_rate, "pressure": pressure,
         "rest": rest, "steps": steps, "literature": literature, "mean": mean_value}


def measure(record: Record, check: dict, folder: Path) -> Finding:
    """Takes the measure that `check` names from a record of the particle solver."""
    if check["kind"] not in KINDS:
        raise SceneMismatch(f"there is no check of kind '{check['kind']}'; there are: {', '.join(KINDS)}")
    finding = KINDS[check["kind"]](record, Scene.of_toml(record.manifest["scene_toml"]), check, folder)
    if not math.isfinite(finding.error):
        raise Missing("the value is not a number")
    return finding
