"""What a cost study runs: validation/<case>/cost.toml, read and checked.

cost.toml:
  title, says            what the case is
  scene                  of the particles (else scene.toml); reference_scene, of the reference (else the same)
  block                  true: no scenes but blocks of material, and the points are options (block_point.py)
  repeats                how often every point is run (else 3); a curve may have its own, or a list of them, one a point
  [truth]                one of
    levels               three lists of overrides of the reference, each twice as fine as the one before in mesh and
                         step: extrapolated, quantity by quantity
    exact, published     name of a solution of validation/verify/exact.py; or numbers by quantity
  [quantity.NAME]        an error: says, kind and what the kind needs (quantities.py). The error of a point is the
                         largest of all
  [curve.NAME]           says, solver ("particles" or "reference"), fixed (overrides of every point), points (a list of
                         lists of overrides), each with a record of its own; quick (numbers of the points that --quick
                         takes); limit (number of the point with the finest of what the curve changes: the others'
                         distance from it is what that choice alone costs); floor, in words why the curve's errors
                         span no decade, where they do not; twin (of one point: CURVE.NUMBER of the other solver at the
                         same spacing)
"""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import quantities

SOLVERS = ("particles", "reference")


class WrongPlan(Exception):
    pass


@dataclass(frozen=True)
class Point:
    """One setting of one solver."""

    curve: str
    number: int
    solver: str
    overrides: tuple
    repeats: int

    @property
    def name(self) -> str:
        return f"{self.curve}.{self.number}"


@dataclass
class Plan:
    case: Path
    table: dict
    quick: bool = False
    points: list = field(default_factory=list)

    @property
    def quantities(self) -> dict:
        return self.table["quantity"]

    @property
    def truth(self) -> dict:
        return self.table["truth"]

    def levels(self) -> list:
        """Overrides of the reference's levels, coarse to fine; the quick study goes without the finest."""
        return [tuple(one) for one in self.truth.get("levels", [])]

    @property
    def block(self) -> bool:
        return bool(self.table.get("block", False))

    def scene(self, solver: str) -> Path:
        if self.block:
            return self.case / "cost.toml"
        name = self.table.get("scene", "scene.toml")
        return self.case / (self.table.get("reference_scene", name) if solver == "reference" else name)

    def point(self, name: str) -> Point:
        for one in self.points:
            if one.name == name:
                return one
        raise WrongPlan(f"{self.case.name} has no point '{name}'")


def check(file: Path, table: dict) -> None:
    def refuse(text: str):
        raise WrongPlan(f"{file}: {text}")

    truth = table.get("truth", {})
    kinds = [kind for kind in ("levels", "exact", "published") if kind in truth]
    if len(kinds) != 1:
        refuse("[truth] has one of levels, exact, published")
    if "levels" in truth and len(truth["levels"]) != 3:
        refuse("[truth] levels are three, each twice as fine as the one before")
    for name, one in table.get("quantity", {}).items():
        if one.get("kind") not in quantities.KINDS:
            refuse(f"[quantity.{name}] kind must be one of {', '.join(quantities.KINDS)}, not {one.get('kind')!r}")
        if not one.get("says"):
            refuse(f"[quantity.{name}] lacks 'says', in words what the error is")
    if not table.get("quantity"):
        refuse("has no [quantity.<name>]: nothing would be measured")
    for name, curve in table.get("curve", {}).items():
        if curve.get("solver") not in SOLVERS:
            refuse(f"[curve.{name}] solver must be one of {', '.join(SOLVERS)}, not {curve.get('solver')!r}")
        if not curve.get("points") or not all(isinstance(one, list) for one in curve["points"]):
            refuse(f"[curve.{name}] points must be a list of lists of overrides")
        if "." in name:
            refuse(f"[curve.{name}]: no dot in a curve's name")
        for key in ("quick", "limit"):
            numbers = curve.get(key, [])
            for number in numbers if isinstance(numbers, list) else [numbers]:
                if not 0 <= number < len(curve["points"]):
                    refuse(f"[curve.{name}] {key} names point {number}; there are {len(curve['points'])}, from 0 on")
        twin, _, number = str(curve.get("twin", f"{name}.0")).rpartition(".")
        if not number.isdigit() or int(number) >= len(table["curve"].get(twin, {}).get("points", [])):
            refuse(f"[curve.{name}] twin names no point: {curve['twin']}")
        repeats = curve.get("repeats", 1)
        if isinstance(repeats, list) and len(repeats) != len(curve["points"]):
            refuse(f"[curve.{name}] repeats has {len(repeats)} numbers for {len(curve['points'])} points")
    if not table.get("curve"):
        refuse("has no [curve.<name>]")


def read(case: Path, quick: bool = False) -> Plan:
    """The plan of a case's study; `quick`: the points that its curves name for it, once each."""
    file = case / "cost.toml"
    try:
        table = tomllib.loads(file.read_text())
    except FileNotFoundError:
        raise WrongPlan(f"there is no {file}; a case with one has a study of its cost") from None
    except tomllib.TOMLDecodeError as fault:
        raise WrongPlan(f"{file}: {fault}") from None
    check(file, table)
    plan = Plan(case, table, quick)
    for name, curve in table["curve"].items():
        repeats = curve.get("repeats", table.get("repeats", 3))
        chosen = curve.get("quick", []) if quick else range(len(curve["points"]))
        for k in chosen:
            times = 1 if quick else int(repeats[k] if isinstance(repeats, list) else repeats)
            overrides = tuple([*curve.get("fixed", []), *curve["points"][k]])
            plan.points.append(Point(name, k, curve["solver"], overrides, times))
    if not plan.points:
        raise WrongPlan(f"{file}: no curve names points for --quick")
    return plan
