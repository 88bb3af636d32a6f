"""What a figure of a hard.toml measures in one run: see hard_study.py for the format.

Every kind is one function of (record, figure); it returns a Finding: the value that is judged, and a curve or none.
A record that lacks what is asked for raises Missing.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

import measures
from measures import FLUID, Missing
from scene import Scene

from record import Record, quantity  # noqa: I001  (scene.py made the reader known)

SOLID = 0.0  # Role::solid of sph/particles.hpp


@dataclass
class Finding:
    value: float
    axis: list = field(default_factory=list)  # of the curve: time, mostly
    found: list = field(default_factory=list)
    axes: tuple = ("", "")


def amount(value) -> float:
    return quantity(value) if isinstance(value, str) else float(value)


def scale_of(figure: dict, scene: Scene, column) -> float:
    """What a value is divided by: "spacing", "start" (the column's first value), a quantity or a number; 1 where none is
    named."""
    scale = figure.get("scale", 1.0)
    if scale == "start":
        if column[0] == 0.0:
            raise Missing(f"{figure['column']} is 0 at the start, no scale")
        return float(column[0])
    return scene.spacing if scale == "spacing" else amount(scale)


def snapshots(record: Record, figure: dict):
    begin = quantity(figure["from"]) if "from" in figure else -math.inf
    times = [t for t in record.snapshot_times() if t >= begin - 1e-9]
    if not times:
        raise Missing("no snapshot so late")
    return (record.snapshot(t) for t in times)


def closest_pair(record: Record, figure: dict) -> Finding:
    """Smallest distance between two particles of fluid or solid in any snapshot, over the spacing."""
    spacing, times, least = Scene.of_toml(record.manifest["scene_toml"]).spacing, [], []
    for snapshot in snapshots(record, figure):
        places = snapshot.positions[snapshot.fields["role"] <= FLUID]
        distance, _ = cKDTree(places).query(places, k=2)
        times.append(snapshot.time)
        least.append(float(np.min(distance[:, 1])) / spacing)
    return Finding(min(least), times, least, ("t [s]", "closest pair / spacing"))


def ledger(record: Record, series: str):
    values = record.series(series)
    if values is None or len(values) < 2:
        raise Missing(f"no series '{series}'")
    return values


def energy_error(record: Record, figure: dict) -> Finding:
    """Kinetic energy against the exact one: the largest difference over the exact energy at the start."""
    scene, energies = Scene.of_toml(record.manifest["scene_toml"]), ledger(record, "ledger_energy")
    flow = measures.flow_of(figure, scene)
    wanted = flow.kinetic_energy(energies["time"])
    error = (energies["kinetic_fluid"] - wanted) / wanted[0]
    return Finding(float(np.max(np.abs(error))), energies["time"].tolist(), (100.0 * error).tolist(),
                   ("t [s]", "energy error, % of the start"))


def decay_rate(record: Record, figure: dict) -> Finding:
    """Slope of the logarithm of the kinetic energy, from the start to `until`, against the exact one's: relative."""
    scene, energies = Scene.of_toml(record.manifest["scene_toml"]), ledger(record, "ledger_energy")
    time = energies["time"]
    early = (time > 0.0) & (time <= amount(figure["until"]))
    exact = measures.flow_of(figure, scene).kinetic_energy(time[early])
    rate, wanted = (np.polyfit(time[early], np.log(e), 1)[0] for e in (energies["kinetic_fluid"][early], exact))
    return Finding(abs(rate / wanted - 1.0), time[1:].tolist(), np.log(energies["kinetic_fluid"][1:]).tolist(),
                   ("t [s]", "log of the kinetic energy"))


def plateau(record: Record, figure: dict) -> Finding:
    """Spread (standard deviation) of the kinetic energy over its mean, from `from` on."""
    energies = ledger(record, "ledger_energy")
    late = energies["time"] >= amount(figure["from"])
    if np.count_nonzero(late) < 10:
        raise Missing(f"the run did not come to {figure['from']}")
    kinetic = energies["kinetic_fluid"][late]
    return Finding(float(np.std(kinetic) / np.mean(kinetic)), energies["time"].tolist(),
                   energies["kinetic_fluid"].tolist(), ("t [s]", "kinetic energy"))


def published(record: Record, figure: dict) -> Finding:
    """verify's check against a published column: rms over its points."""
    folder = figure["folder"] / figure.get("literature_of", ".")
    found = measures.measure(record, {**figure, "kind": "literature"}, folder.resolve())
    curve = found.curves[0]
    return Finding(found.error, curve.axis, curve.found, found.axes)


def solid_over_fluid(record: Record, figure: dict) -> Finding:
    """Fastest solid particle over the fastest fluid particle, largest over the snapshots after the start."""
    times, ratios = [], []
    for snapshot in snapshots(record, figure):
        if snapshot.time <= 0.0:
            continue
        speed, role = np.linalg.norm(snapshot.fields["velocity"], axis=1), snapshot.fields["role"]
        times.append(snapshot.time)
        ratios.append(float(np.max(speed[role == SOLID]) / np.max(speed[role == FLUID])))
    return Finding(max(ratios), times, ratios, ("t [s]", "fastest solid / fastest fluid"))


def series(record: Record, figure: dict) -> Finding:
    """max, min, last, mean, range or largest (in size) of a series' column from `from` on, over `scale`."""
    values = ledger(record, figure["series"])
    whole = values[figure["column"]]
    late = values["time"] >= amount(figure.get("from", 0.0)) - 1e-12
    column = whole[late] / scale_of(figure, Scene.of_toml(record.manifest["scene_toml"]), whole)
    if len(column) == 0:
        raise Missing(f"the run did not come to {figure['from']}")
    take = {"max": np.max, "min": np.min, "last": lambda v: v[-1], "mean": np.mean, "range": np.ptp,
            "largest": lambda v: np.max(np.abs(v))}[figure["take"]]
    step = max(1, len(column) // 1500)
    return Finding(float(take(column)), values["time"][late][::step].tolist(), column[::step].tolist(),
                   ("t [s]", figure.get("label", figure["column"].replace("_", " "))))


def settled(record: Record, figure: dict) -> Finding:
    """Mean of a column over the last third against the third before, relative: what still changes late."""
    values = ledger(record, figure["series"])
    time, column = values["time"], values[figure["column"]]
    end = quantity(Scene.of_toml(record.manifest["scene_toml"]).text("time.end"))
    if time[-1] < 0.99 * end:
        raise Missing("the run did not come to its end")
    third = [np.mean(column[(time > a * end / 3) & (time <= (a + 1) * end / 3)]) for a in (1, 2)]
    step = max(1, len(column) // 1500)
    return Finding(float(abs(third[1] / third[0] - 1.0)), time[::step].tolist(), column[::step].tolist(),
                   ("t [s]", figure.get("label", figure["column"].replace("_", " "))))


def bodies(snapshot, spacing: float) -> np.ndarray:
    """Number of the body of every solid particle, by who touches whom at the start; by identity."""
    solid = snapshot.fields["role"] == SOLID
    places, identity = snapshot.positions[solid], snapshot.fields["identity"][solid].astype(int)
    pairs = cKDTree(places).sparse_distance_matrix(cKDTree(places), 1.2 * spacing)
    _, number = connected_components(pairs)
    result = np.zeros(identity.max() + 1, dtype=int)
    result[identity] = number
    return result


def body_gap(record: Record, figure: dict) -> Finding:
    """Smallest distance between particles of different bodies in any snapshot, over the spacing."""
    spacing, times, least = Scene.of_toml(record.manifest["scene_toml"]).spacing, [], []
    number = bodies(record.snapshot(record.snapshot_times()[0]), spacing)  # later they may touch
    for snapshot in snapshots(record, figure):
        solid = snapshot.fields["role"] == SOLID
        places, own = snapshot.positions[solid], number[snapshot.fields["identity"][solid].astype(int)]
        if np.max(own) < 1:
            raise Missing("the scene has one body")
        distance, _ = cKDTree(places[own == 0]).query(places[own == 1])
        times.append(snapshot.time)
        least.append(float(np.min(distance)) / spacing)
    return Finding(min(least), times, least, ("t [s]", "gap between the bodies / spacing"))


def wall_gap(record: Record, figure: dict) -> Finding:
    """Smallest height over the bottom wall of solid particles that began above `above`, over the spacing."""
    scene, times, least, high = Scene.of_toml(record.manifest["scene_toml"]), [], [], None
    low = scene.box[0][1]
    for snapshot in record_start(record):
        solid = snapshot.fields["role"] == SOLID
        places, identity = snapshot.positions[solid], snapshot.fields["identity"][solid]
        if high is None:
            high = set(identity[places[:, 1] > low + quantity(figure["above"])].tolist())
        upper = np.array([one in high for one in identity.tolist()])
        times.append(snapshot.time)
        least.append(float(np.min(places[upper, 1]) - low) / scene.spacing)
    return Finding(min(least), times, least, ("t [s]", "lowest part of the beam over the wall / spacing"))


def record_start(record: Record):
    return (record.snapshot(t) for t in record.snapshot_times())


def closings(record: Record, figure: dict) -> Finding:
    """How often two bodies met (closer than 1.3 spacings) after having been apart (farther than 2)."""
    gaps, apart, count = body_gap(record, figure), True, 0
    for gap in gaps.found:
        count += apart and gap < 1.3
        apart = gap > 2.0 or (apart and gap >= 1.3)
    return Finding(float(count), gaps.axis, gaps.found, gaps.axes)


def sweeper(record: Record):
    """A function of a snapshot: area (m2) that the bodies have swept downstream since the start, the sum over their
    particles of volume / thickness x displacement along the thickness."""
    scene, start = Scene.of_toml(record.manifest["scene_toml"]), record.snapshot(record.snapshot_times()[0])
    solid = start.fields["role"] == SOLID
    order = np.argsort(start.fields["identity"][solid])
    places, number = start.positions[solid][order][:, :2], bodies(start, scene.spacing)
    tables = list(scene.entry("solid").values())
    corners = [[np.array([quantity(v) for v in table["body"][end]]) for end in ("from", "to")] for table in tables]
    weight = np.zeros((len(places), 2))
    for body in range(number.max() + 1):
        own = number == body
        nearest = int(np.argmin([np.linalg.norm(0.5 * (a + b) - places[own].mean(axis=0)) for a, b in corners]))
        extent = corners[nearest][1] - corners[nearest][0]
        angle = math.radians(tables[nearest]["body"].get("angle_degrees", 0.0)) + (0 if extent[0] < extent[1] else math.pi / 2)
        normal = np.array([math.cos(angle), math.sin(angle)])
        weight[own] = math.copysign(np.prod(extent) / np.sum(own) / np.min(extent), normal[0]) * normal

    def swept(snapshot) -> float:
        now = snapshot.fields["role"] == SOLID
        moved = snapshot.positions[now][np.argsort(snapshot.fields["identity"][now])][:, :2] - places
        return float(np.sum(weight * moved))
    return swept


def closed_leak(record: Record, figure: dict) -> Finding:
    """Mean flow past the bodies while they touch (closer than 1.3 spacings), over the mean of the flow's size while they
    do not, from `from` on. The flow is that of the fluid between 80 and 95 % of the channel's length; what the bodies
    sweep as they bend and ring behind their contact is no leak and is taken off."""
    (low, bottom), (high, top) = (corner[:2] for corner in Scene.of_toml(record.manifest["scene_toml"]).box)
    gaps, swept, area, times, flow = body_gap(record, figure), sweeper(record), [], [], []
    for snapshot in snapshots(record, figure):
        x = (snapshot.positions[:, 0] - low) / (high - low)
        there = (snapshot.fields["role"] == FLUID) & (x > 0.8) & (x < 0.95)
        times.append(snapshot.time)
        flow.append(float(np.mean(snapshot.fields["velocity"][there, 0])) * (top - bottom))
        area.append(swept(snapshot))
    closed, flow = np.array(gaps.found) < 1.3, np.array(flow)
    if not closed.any() or closed.all():
        raise Missing("the bodies never parted" if closed.all() else "the bodies never met")
    both, step = closed[1:] & closed[:-1], np.diff(times)
    if not both.any():
        raise Missing("the bodies never touched from one snapshot to the next")
    past = 0.5 * (flow[1:] + flow[:-1]) * step - np.diff(area)
    leak = float(np.sum(past[both]) / np.sum(step[both]))
    return Finding(abs(leak) / float(np.mean(np.abs(flow[~closed]))), times, flow.tolist(), ("t [s]", "flow [m2/s]"))


def reopening(record: Record, figure: dict) -> Finding:
    """Longest delay from the start of a beat (k `period`, when the pressure turns) to when two points of two bodies have
    come half-way from their closest in the half beat before to their farthest in the half beat after, over the period.
    `apart`: the distance of the points at rest, across."""
    first, second = (ledger(record, name) for name in figure["series"])
    time, period = first["time"], amount(figure["period"])
    across = amount(figure["apart"]) + second["displacement_y"] - first["displacement_y"]
    apart = np.hypot(second["displacement_x"] - first["displacement_x"], across)
    begins, delays = [], []
    for beat in np.arange(1, math.floor(time[-1] / period - 0.5) + 1) * period:
        before = (time > beat - 0.5 * period) & (time <= beat)
        after = (time > beat) & (time <= beat + 0.5 * period)
        half = 0.5 * (np.min(apart[before]) + np.max(apart[after]))
        begins.append(float(beat))
        delays.append(float(time[after][np.argmax(apart[after] > half)] - beat) / period)
    if not delays:
        raise Missing("no beat is complete")
    return Finding(max(delays), begins, delays, ("t [s]", "delay of reopening / period"))


def beats(record: Record, figure: dict) -> Finding:
    """How often a column of a series went through a whole swing: upward crossings of its middle, of beats in which
    it swung by at least half of its largest swing."""
    values = ledger(record, figure["series"])
    column, time = values[figure["column"]], values["time"]
    middle, half = 0.5 * (np.max(column) + np.min(column)), 0.25 * np.ptp(column)
    state, count = -1, 0
    for value in column - middle:
        if state < 0 and value > half:
            state, count = 1, count + 1
        elif state > 0 and value < -half:
            state = -1
    step = max(1, len(column) // 3000)
    return Finding(float(count), time[::step].tolist(), column[::step].tolist(),
                   ("t [s]", figure.get("label", "displacement [m]")))


KINDS = {"closest_pair": closest_pair, "energy_error": energy_error, "decay_rate": decay_rate, "plateau": plateau,
         "published": published, "solid_over_fluid": solid_over_fluid, "series": series, "settled": settled,
         "body_gap": body_gap, "wall_gap": wall_gap, "closings": closings, "closed_leak": closed_leak,
         "reopening": reopening, "beats": beats}


def measure(record: Record, figure: dict) -> Finding:
    finding = KINDS[figure["kind"]](record, figure)
    if not math.isfinite(finding.value):
        raise Missing("the value is not a number")
    return finding
