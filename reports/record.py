"""Reads the records that the solvers write (scene/record.hpp describes the files). Never writes one."""

import json
import re
from dataclasses import dataclass
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

    def snapshot(self, time: float) -> Snapshot | None:
        for group in self._file["fields"].values():
            if abs(float(group.attrs["time"]) - time) < SAME_TIME:
                fields = {name: data[...] for name, data in group["fields"].items()}
                cells = group["cells"][...]
                return Snapshot(time, group["positions"][...], cells if cells.shape[1] > 1 else None, fields)
        return None

    @property
    def finished(self) -> bool:
        return self.manifest.get("outcome") == "finished"

    @property
    def cost(self) -> list[tuple[str, float]]:
        return [(entry["phase"], float(entry["seconds"])) for entry in self.manifest.get("cost", [])]


def quantity(text: str) -> float:
    """SI value of the few lengths and times that a drawing needs from a resolved scene ("3.75 mm")."""
    match = re.fullmatch(r"\s*([-+0-9.eE]+)\s*(k|m|c|u)?(m|s)\s*", text)
    if not match:
        raise ValueError(f"not a length or a time: {text!r}")
    scale = {None: 1.0, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6}[match[2]]
    return float(match[1]) * scale
