"""The tables of a report: measurements turned so that a person reads them."""

import json
from dataclasses import dataclass

TITLES = {
    "velocity_difference": "velocity profile, largest difference",
    "velocity_difference_rms": "velocity profile, rms difference",
    "velocity_difference_transverse": "velocity profile, largest transverse difference",
    "displacement_difference": "displacement, difference",
    "displacement_difference_x": "displacement x, signed difference",
    "displacement_difference_y": "displacement y, signed difference",
    "displacement_l2": "displacement history, relative L2",
    "displacement_lag": "displacement history, lag",
    "displacement_amplitude_ratio": "displacement history, amplitude ratio",
    "outline_distance": "outline, largest distance",
    "outline_distance_rms": "outline, rms distance",
    "outline_distance_relative": "outline, largest distance over displacement",
    "outline_distance_material": "outline, material points",
    "force_difference_x": "force x, signed difference",
    "force_difference_y": "force y, signed difference",
    "force_scatter": "force x, scatter in the window",
    "excess_outflow": "outflow minus inflow, over the channel",
    "particle_drift": "number of particles, drift",
    "lost_particles": "particles lost",
    "divergence_rms": "remaining divergence, rms",
    "solid_area_change": "area of the solids, change",
    "solid_max_stretch": "largest stretch",
    "processor_time": "processor time",
    "wall_time": "wall time",
}
PLAIN_NUMBERS = {"lost_particles", "displacement_amplitude_ratio", "solid_max_stretch"}
MARKS = {"pass": "✓ pass", "fail": "✗ fail", "not judged": "? not judged", "reported": ""}


def number(value: float | None, measure: str, unit: str) -> str:
    """A value as people write it: ratios in per cent, lengths in mm, times below 1 s in ms."""
    if value is None:
        return "–"
    if measure == "lost_particles":
        return f"{value:.0f}"
    if measure in PLAIN_NUMBERS:
        return f"{value:.3f}"
    if unit == "1":
        return f"{100 * value:.2f} %" if abs(value) >= 1e-4 or value == 0 else f"{100 * value:.1g} %"
    if unit == "m":
        return f"{1e3 * value:.3g} mm"
    if unit == "s" and abs(value) < 1.0:
        return f"{1e3 * value:.3g} ms"
    return f"{value:.4g} {unit}"


@dataclass
class Cell:
    value: str
    error: str
    verdict: str
    mark: str
    remark: str
    sides: str


@dataclass
class Row:
    title: str
    definition: str
    subject: str
    cells: list[Cell]
    limit: str
    because: str
    remark: str  # one that holds for every cell


def _take_common_remark(cells: list[Cell]) -> str:
    """A remark that all cells share moves to the row: once is enough."""
    remarks = {c.remark for c in cells}
    if len(cells) < 2 or len(remarks) != 1:
        return ""
    for c in cells:
        c.remark = ""
    return remarks.pop()


def cell(m: dict | None) -> Cell:
    if m is None:
        return Cell("", "", "reported", "", "", "")
    show = lambda value: number(value, m["measure"], m["unit"])  # noqa: E731
    error = f"± {show(m['reference_error'])}" if m["reference_error"] is not None and m["value"] is not None else ""
    sides = ""
    if m["candidate"] is not None and m["reference"] is not None:
        sides = (f"{number(m['candidate'], m['measure'], m['sides_unit'])} against "
                 f"{number(m['reference'], m['measure'], m['sides_unit'])}")
    return Cell(show(m["value"]), error, m["verdict"].replace(" ", "-"), MARKS[m["verdict"]], m["remark"], sides)


class Tables:
    def __init__(self, sides):
        self.comparison = sides.comparison
        self.definitions = {m["name"]: m for m in self.comparison["measures"]}
        self._records = [sides.reference, *sides.runs]

    def times(self) -> list[float]:
        return self.comparison["judged_at"]

    def _rows(self, run: dict, timed: bool, keep) -> list[Row]:
        groups: dict[tuple[str, str], list[dict]] = {}
        for m in run["measurements"]:
            if (m["time"] is not None) == timed:
                groups.setdefault((m["measure"], m["subject"]), []).append(m)
        rows = []
        for (measure, subject), members in groups.items():
            if not keep(members):
                continue
            limited = next((m for m in members if m["limit"] is not None), None)
            if timed:
                at = {round(m["time"], 6): m for m in members}
                cells = [cell(at.get(round(t, 6))) for t in self.times()]
            else:
                cells = [cell(members[0])]
            remark = _take_common_remark(cells)
            limit = number(limited["limit"], measure, members[0]["unit"]) if limited else ""
            rows.append(Row(TITLES.get(measure, measure), self.definitions[measure]["definition"], subject,
                            cells, limit, limited["because"] if limited else "", remark))
        return rows

    def judged(self, run: dict, timed: bool) -> list[Row]:
        return self._rows(run, timed, lambda members: any(m["limit"] is not None for m in members))

    def reported(self, run: dict, timed: bool) -> list[Row]:
        return self._rows(run, timed, lambda members: all(m["limit"] is None for m in members))

    def error_bar_cost(self) -> tuple[int, float] | None:
        """How many further runs the reference's error bar took, and their processor seconds."""
        file = self._records[0].folder / "error_bar.json"
        runs = json.loads(file.read_text()).get("runs", []) if file.is_file() else []
        further = [run["processor_seconds"] for run in runs if run["name"] != "this run"]
        return (len(further), sum(further)) if further else None

    def costs(self) -> list[dict]:
        rows = []
        for record in self._records:
            manifest = record.manifest
            numbers = manifest.get("numbers", {})
            size = next((f"{numbers[k]:,.0f} {k}".replace("_", " ") for k in ("particles", "unknowns")
                         if k in numbers), "")
            rows.append({
                "record": record, "size": size,
                "processor": f"{manifest.get('processor_seconds', 0):.4g} s",
                "wall": f"{manifest.get('wall_seconds', 0):.4g} s",
                "threads": manifest.get("threads", ""),
                "memory": f"{manifest.get('peak_memory_bytes', 0) / 2**20:.0f} MiB",
            })
        return rows

    def error_bars(self) -> list[dict]:
        return self.comparison["reference"]["error_bar"]

    @staticmethod
    def manifest_text(record) -> str:
        facts = {k: v for k, v in record.manifest.items() if k not in ("scene_toml", "cost")}
        return json.dumps(facts, indent=2, ensure_ascii=False)

    @staticmethod
    def scene_text(record) -> str:
        return record.manifest.get("scene_toml", "")
