"""How far two records of the same scene are apart, in every quantity that they hold.

Series (displacements, forces, ledgers) are compared over time: relative L2 of the difference, lag, and the ratio of
amplitudes once the lag is taken out. Tables (profiles, outlines) are compared time by time: relative L2. A part of a
quantity that is nearly nothing (the transverse velocity of a straight flow) is measured against the whole vector.
"""

import re
from dataclasses import dataclass

import numpy as np

from record import Record  # noqa: I001  (made known by the caller's import of quantities)

SAMPLES = 301
LARGEST_LAG = 0.05  # of the common time
SERIES_LEFT_OUT = ("ledger_divergence", "ledger_solver", "ledger_particles")  # how it ran, not what came out
COMPONENT = re.compile(r"(.*)_([xyz])$")


@dataclass
class Difference:
    quantity: str
    l2: float  # relative
    lag: float | None  # s; positive: the second is late
    amplitude: float | None  # of the second over the first


def histories(record: Record) -> dict:
    """Every series as {name.column: values at SAMPLES even times}, and "time"."""
    names = [name for name in record._file["series"] if name not in SERIES_LEFT_OUT]
    found, end = {}, min(record.series(name)["time"][-1] for name in names if record.series(name) is not None)
    time = np.linspace(0.0, end, SAMPLES)
    for name in names:
        series = record.series(name)
        for column in (series.values if series is not None else ()):
            if column != "time":
                found[f"{name}.{column}"] = np.interp(time, series["time"], series[column])
    return {"time": time, **found}


def tables(record: Record) -> dict:
    """Every table as {name.column: {time: values}}: velocities, and of outlines how far each point has moved. Places
    where something was asked for are left out."""
    found = {}
    for name in record._file["tables"]:
        for t in record.table_times(name):
            table = record.table(name, t)
            if "reference_x" in table:
                columns = {f"displacement_{axis}": table[axis] - table[f"reference_{axis}"]
                           for axis in "xyz" if axis in table}
            else:
                columns = {column: table[column] for column in table.values if column not in ("x", "y", "z")}
            for column, values in columns.items():
                found.setdefault(f"{name}.{column}", {})[f"{t:.6g}"] = values
    return found


def kept(record: Record) -> dict:
    """What of a record is enough to compare it by: small, and ready for JSON."""
    series = {name: np.asarray(values).tolist() for name, values in histories(record).items()}
    rows = {name: {t: values.tolist() for t, values in one.items()} for name, one in tables(record).items()}
    return {"series": series, "tables": rows}


def scale_of(name: str, everything: dict) -> float:
    """Length of the vector that the component `name` belongs to, over all of it; of itself if it is none."""
    match = COMPONENT.match(name)
    family = [other for other in everything if match and COMPONENT.match(other)
              and COMPONENT.match(other)[1] == match[1]] or [name]
    return float(np.sqrt(sum(np.sum(np.square(everything[other])) for other in family)))


def lag_and_amplitude(time: np.ndarray, first: np.ndarray, second: np.ndarray) -> tuple:
    """The shift that best lays the second on the first, to a parabola between samples, and the factor then."""
    step, n = time[1] - time[0], len(time)
    reach = max(1, int(LARGEST_LAG * n))
    a, b = first - first.mean(), second - second.mean()

    def overlap(k):
        x, y = (a[: n - k], b[k:]) if k >= 0 else (a[-k:], b[: n + k])
        return float(np.dot(x, y) / np.sqrt(np.dot(x, x) * np.dot(y, y) or 1.0))

    shifts = list(range(-reach, reach + 1))
    match = [overlap(k) for k in shifts]
    k = int(np.argmax(match))
    bend = 0.0
    if 0 < k < len(match) - 1:
        curvature = match[k - 1] - 2.0 * match[k] + match[k + 1]
        bend = 0.5 * (match[k - 1] - match[k + 1]) / curvature if curvature < 0.0 else 0.0
    lag = (shifts[k] + bend) * step
    moved = np.interp(time + lag, time, second)
    inside = (time + lag >= time[0]) & (time + lag <= time[-1])
    x, y = first[inside] - first[inside].mean(), moved[inside] - moved[inside].mean()
    return lag, float(np.dot(x, y) / np.dot(x, x)) if np.dot(x, x) > 0.0 else None


def differences(first: dict, second: dict) -> list[Difference]:
    """Of two answers of kept(): the second's from the first's, for every quantity that the first has."""
    found = []
    a = {name: np.array(values) for name, values in first["series"].items()}
    b = {name: np.array(values) for name, values in second["series"].items()}
    time = a.pop("time")
    later = b.pop("time", time)
    for name, values in a.items():
        size = scale_of(name, a)
        if name not in b or size == 0.0:
            continue
        other = np.interp(time, later, b[name])
        lag, amplitude = lag_and_amplitude(time, values, other)
        found.append(Difference(name, float(np.linalg.norm(other - values) / size), lag, amplitude))
    for t in sorted({t for one in first["tables"].values() for t in one}, key=float):
        at = {name: np.array(one[t]) for name, one in first["tables"].items() if t in one}
        for name, values in at.items():
            size, other = scale_of(name, at), second["tables"].get(name, {}).get(t)
            if size > 0.0 and other is not None and len(other) == len(values):
                found.append(Difference(f"{name} at {t} s", float(np.linalg.norm(other - values) / size), None, None))
    return found
