"""The numbers of a record that a study compares, and how far two sets of them are apart.

A quantity is an array: rows are the times (or the parts) that are judged each on its own, columns the numbers of one.
Its error is the largest of the rows' errors, each a norm of the difference over a scale.
"""

import math
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "validation" / "verify")]

import exact  # noqa: E402
from scene import Scene  # noqa: E402

from record import Record, quantity  # noqa: E402, I001


class Missing(Exception):
    """The record lacks what is asked for, or the run did not come so far."""


def times_of(one: dict) -> list:
    return [quantity(text) for text in one["times"]]


def series_at(record: Record, name: str, columns: list, times: list) -> np.ndarray:
    """Columns of a series at the times, linear between its samples. (times, columns)"""
    series = record.series(name)
    if series is None:
        raise Missing(f"no series '{name}'")
    if series["time"][-1] < times[-1] - 1e-6:
        raise Missing(f"the run ended at {series['time'][-1]:.4g} s, before {times[-1]:g} s")
    return np.column_stack([np.interp(times, series["time"], series[column]) for column in columns])


def table_at(record: Record, name: str, column: str, t: float) -> np.ndarray:
    table = record.table(name, t)
    if table is None:
        raise Missing(f"no table '{name}' at {t:g} s")
    return table[column]


def displacement(record: Record, one: dict) -> np.ndarray:
    """Displacement vector of a probe at each time, relative to its length there."""
    return series_at(record, one["probe"], ["displacement_x", "displacement_y"], times_of(one))


def profile(record: Record, one: dict) -> np.ndarray:
    """One component of velocity along a line, a row a time, over `scale`."""
    column = f"velocity_{one.get('component', 'x')}"
    return np.array([table_at(record, one["probe"], column, t) for t in times_of(one)])


def mean_profile(record: Record, one: dict) -> np.ndarray:
    """The mean over the times of such a line, one row, over `scale`."""
    return np.mean(profile(record, one), axis=0)[None]


def energy(record: Record, one: dict) -> np.ndarray:
    """Kinetic energy of the fluid at the times, a row each, relative to the true one."""
    return series_at(record, "ledger_energy", ["kinetic_fluid"], times_of(one))


def mean_value(record: Record, one: dict) -> np.ndarray:
    """Mean of a series' column (less the column `minus`) from `from` on, times `factor`, weighted by the steps."""
    series = record.series(one["probe"])
    if series is None:
        raise Missing(f"no series '{one['probe']}'")
    time, begin = series["time"], quantity(one["from"])
    if time[-1] < quantity(one["until"]) - 1e-6:
        raise Missing(f"the run ended at {time[-1]:.4g} s, before {one['until']}")
    late = time >= begin - 1e-9
    values = one.get("factor", 1.0) * (series[one["column"]] - (series[one["minus"]] if "minus" in one else 0.0))
    weight = np.diff(time, prepend=time[0])[late]
    return np.array([[np.average(values[late], weights=weight)]])


def no_record(record: Record, one: dict) -> np.ndarray:
    raise Missing("a block's strain is read from its table (block_point.py), not from a record")


KINDS = {"strain": no_record, "displacement": displacement, "profile": profile, "mean_profile": mean_profile, "energy": energy,
         "mean_value": mean_value}
NORMS = {"profile": "max", "mean_profile": "rms"}  # of a row's difference; the others' is its length


def take(record: Record, one: dict) -> np.ndarray:
    values = KINDS[one["kind"]](record, one)
    if not np.all(np.isfinite(values)):
        raise Missing("a value is not a number")
    return values


def true_energy(name: str, scene: Path, one: dict) -> np.ndarray:
    """Of an exact solution, in the shape that energy() has."""
    flow = exact.solution(name, Scene.of_toml(scene.read_text()), {})
    return np.asarray(flow.kinetic_energy(np.array(times_of(one))))[:, None]


def strain_under_pull(stress_over_modulus: float) -> float:
    """Stretch less one of an incompressible neo-Hookean body under a nominal stress: sigma = E/3 (s - s^-2).

    Newton's method from the linear answer; the slope 1 + 2 s^-3 is positive, so it has one root.
    """
    stretch = 1.0 + stress_over_modulus
    for _ in range(50):
        stretch -= (stretch - stretch**-2 - 3.0 * stress_over_modulus) / (1.0 + 2.0 * stretch**-3)
    return stretch - 1.0


def error(one: dict, values: np.ndarray, true: np.ndarray) -> float:
    """Largest of the rows' errors: over `scale` where the quantity has one, else over the true row's length."""
    if values.shape != true.shape:
        raise Missing(f"{values.shape} numbers against {true.shape}")
    difference = values - true
    norm = one.get("norm", NORMS.get(one["kind"], "length"))
    size = {"length": np.linalg.norm(difference, axis=1), "max": np.max(np.abs(difference), axis=1),
            "rms": np.sqrt(np.mean(difference**2, axis=1))}[norm]
    scale = quantity(one["scale"]) if "scale" in one else np.linalg.norm(true, axis=1)
    return float(np.max(size / scale))


def extrapolated(coarse: np.ndarray, middle: np.ndarray, fine: np.ndarray) -> tuple[np.ndarray, float]:
    """Richardson's limit of three levels, each twice as fine as the one before, and the order it trusts.

    The order is that of the whole array's differences, held between 1 and 2: elements of degree 2 at corners and a
    time scheme of second order promise no more, and less than 1 would be no convergence.
    """
    first, second = np.linalg.norm(middle - coarse), np.linalg.norm(fine - middle)
    order = math.log2(first / second) if first > 0.0 and second > 0.0 else 2.0
    order = min(max(order, 1.0), 2.0)
    return fine + (fine - middle) / (2.0**order - 1.0), order
