"""Reads the records that the solvers write (scene/record.hpp describes the files). Never writes one."""

import json
import re
from bisect import bisect_left
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

SAME_TIME = 1e-6  # s; the comparison's own tolerance


@dataclass
class Columns:
    """A series or a table: its columns by name, and their units."""

    values: dict[str, np.ndarray]
    units: dict[str, str]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]

    def __contains__(self, name: str) -> bool:
        return name in self.values

    def __len__(self) -> int:
        return len(next(iter(self.values.values()), ()))


@dataclass
class Snapshot:
    """Fields over points: positions (n, 3) in m, cells (m, 3 or 4) or None for a cloud of points."""

    time: float
    positions: np.ndarray
    cells: np.ndarray | None
    fields: dict[str, np.ndarray]


def _words(attribute) -> list[str]:
    return [word.decode() if isinstance(word, bytes) else str(word) for word in attribute]


def _columns(data: h5py.Dataset) -> Columns:
    names, units = _words(data.attrs["columns"]), _words(data.attrs["units"])
    rows = data[...]
    return Columns({n: rows[:, i] for i, n in enumerate(names)}, dict(zip(names, units)))


class Record:
    """The record in a folder. Missing series, tables and snapshots are None: a run may have stopped."""

    def __init__(self, folder: Path, label: str):
        self.folder, self.label = Path(folder), label
        self.manifest = json.loads((self.folder / "manifest.json").read_text())
        self._file = h5py.File(self.folder / "record.h5", "r")

    def series(self, name: str) -> Columns | None:
        group = self._file["series"]
        if name not in group or group[name].shape[0] == 0:
            return None
        return _columns(group[name])

    def table(self, name: str, time: float) -> Columns | None:
        group = self._file["tables"].get(name)
        for data in (group.values() if group is not None else ()):
            if abs(float(data.attrs["time"]) - time) < SAME_TIME:
                return _columns(data)
        return None

    def table_times(self, name: str) -> list[float]:
        group = self._file["tables"].get(name)
        return sorted(float(d.attrs["time"]) for d in group.values()) if group is not None else []

    @cached_property
    def _snapshots(self) -> list[tuple[float, str]]:
        """Times and names of the snapshots: read once, for each is asked for by its time."""
        return sorted((float(group.attrs["time"]), name) for name, group in self._file["fields"].items())

    def snapshot(self, time: float) -> Snapshot | None:
        at = bisect_left(self._snapshots, (time - SAME_TIME,))
        if at == len(self._snapshots) or self._snapshots[at][0] >= time + SAME_TIME:
            return None
        group = self._file["fields"][self._snapshots[at][1]]
        fields = {name: data[...] for name, data in group["fields"].items()}
        cells = group["cells"][...]
        return Snapshot(time, group["positions"][...], cells if cells.shape[1] > 1 else None, fields)

    def snapshot_times(self) -> list[float]:
        return [time for time, _ in self._snapshots]

    @property
    def finished(self) -> bool:
        return self.manifest.get("outcome") == "finished"

    @property
    def cost(self) -> list[tuple[str, float]]:
        return [(entry["phase"], float(entry["seconds"])) for entry in self.manifest.get("cost", [])]


PREFIXES = {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1, "k": 1e3, "M": 1e6, "G": 1e9}
UNITS = {"m": 1.0, "s": 1.0, "g": 1e-3, "Hz": 1.0, "N": 1.0, "Pa": 1.0, "P": 0.1, "J": 1.0, "W": 1.0}


def _factor(unit: str) -> float:
    """SI value of one unit, such as mm, m2 or m/s2 (a part of what scene/quantity.cpp knows)."""
    value = 1.0
    for position, group in enumerate(unit.split("/")):
        for word in group.split():
            match = re.fullmatch(r"([^\d^]+)\^?(-?\d*)", word)
            symbol, power = (match[1], int(match[2] or 1)) if match else (word, 1)
            if symbol in UNITS:
                one = UNITS[symbol]
            elif symbol[0] in PREFIXES and symbol[1:] in UNITS:
                one = PREFIXES[symbol[0]] * UNITS[symbol[1:]]
            else:
                raise ValueError(f"unknown unit {symbol!r} in {unit!r}")
            value *= one ** (power if position == 0 else -power)
    return value


def quantity(text: str) -> float:
    """SI value of a quantity of a resolved scene, such as "3.75 mm" or "1000 kg/m3"."""
    match = re.fullmatch(r"\s*([-+0-9.eE]+)(?:\s+(\S.*?))?\s*", text)
    if not match:
        raise ValueError(f"not a quantity: {text!r}")
    return float(match[1]) * (_factor(match[2]) if match[2] else 1.0)
