#!/usr/bin/env python3
"""recommend.py CASE-FOLDER (--error 3% | --time 60s)

Reads the kept table of the case's cost study (CASE-FOLDER/records/cost_study.csv) and names, for each solver, the
cheapest setting that reaches an error, or the most accurate one within a budget of processor time.

The prediction is a straight line in log error and log time through each curve's neighbouring points. Its uncertainty
is measured, not assumed: every inner point of the curve is predicted from the others, as if it had not been run, and
the largest factor between the prediction and what was measured is the factor given (at least the spread of repeats,
and at least the truth's own error). A setting is named only if its error, times that factor, still reaches what is
asked.

Exit codes: 0 a setting is named, 1 none that was measured reaches it, 2 wrong use.
"""

import argparse
import csv
import json
import math
import re
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import plan as plans

from quantities import quantity
from verify import say  # noqa: I001  (plan.py made the driver known)

WRONG_USE, NOT_REACHED = 2, 1


# Of a time that was not repeated: one run of the beam took 71.0 s on a quiet machine and 80.7 s on a busy one.
NOT_REPEATED = 1.2


class NoAnswer(Exception):
    pass


@dataclass
class Measured:
    """A row of the table."""

    curve: str
    solver: str
    setting: str
    error: float
    time: float
    time_spread: float  # most over least of the repeats

    @classmethod
    def of(cls, row: dict) -> "Measured":
        spread = float(row["processor_seconds_most"]) / float(row["processor_seconds_least"])
        return cls(row["curve"], row["solver"], row["setting"], float(row["error"]), float(row["processor_seconds"]),
                   spread if int(row["repeats"]) > 1 else NOT_REPEATED)


@dataclass
class Prediction:
    setting: str
    error: float
    error_factor: float
    time: float
    time_factor: float
    measured: bool

    def __str__(self) -> str:
        how = "measured" if self.measured else "between two that were measured"
        return (f"{self.setting}\n    error {self.error:.2%} ({self.error / self.error_factor:.2%} to "
                f"{self.error * self.error_factor:.2%}), processor time {self.time:.3g} s "
                f"({self.time / self.time_factor:.3g} to {self.time * self.time_factor:.3g} s); {how}")


def read_table(file: Path) -> list[Measured]:
    if not file.exists():
        raise NoAnswer(f"there is no {file}; ./sprung study cost {file.parents[1].name} --accept REASON makes it")
    rows = csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#"))
    return [Measured.of(row) for row in rows if row["error"] and row["processor_seconds"]]


def along(curve: list, x: float, key) -> float:
    """log of key at log time x: linear between neighbours, the end's slope beyond the ends."""
    places = [math.log(one.time) for one in curve]
    values = [math.log(key(one)) for one in curve]
    k = min(max(sum(place <= x for place in places) - 1, 0), len(places) - 2)
    slope = (values[k + 1] - values[k]) / (places[k + 1] - places[k])
    return values[k] + slope * (x - places[k])


def left_out_factor(curve: list) -> float:
    """Largest factor by which an inner point's error differs from what its neighbours say at its time."""
    worst = 1.0
    for k in range(1, len(curve) - 1):
        others = curve[:k] + curve[k + 1:]
        guess = along(others, math.log(curve[k].time), lambda one: one.error)
        worst = max(worst, math.exp(abs(guess - math.log(curve[k].error))))
    return worst


def spacing_of(setting: str) -> float | None:
    match = re.search(r'sph\.spacing="([^"]+)"', setting)
    return quantity(match[1]) if match else None


def with_spacing(setting: str, spacing: float) -> str:
    return re.sub(r'sph\.spacing="[^"]+"', f'sph.spacing="{1e3 * spacing:.12g} mm"', setting)


def dividing(spacing: float, channel: list, finer: bool) -> float | None:
    """The nearest spacing on one side, within a fifth of `spacing`, that divides every side of the channel."""
    parts = math.ceil(channel[0] / spacing - 1e-6) if finer else math.floor(channel[0] / spacing + 1e-6)
    while parts > 0 and 0.8 < channel[0] / parts / spacing < 1.25:
        fits = [side * parts / channel[0] for side in channel]
        if all(abs(count - round(count)) < 1e-6 for count in fits):
            return channel[0] / parts
        parts += 1 if finer else -1
    return None


def at_time(curve: list, time: float, factor: float, channel: list, finer: bool) -> Prediction | None:
    """The setting of a curve of spacings that takes `time` at least (finer) or most; None where the channel has no such spacing."""
    coarse = max((one for one in curve if one.time <= time * 1.0001), key=lambda one: one.time)
    wanted = math.exp(along(curve, math.log(time), lambda one: spacing_of(one.setting)))
    spacing = dividing(wanted, channel, finer)
    if spacing is None:
        return None
    for one in curve:  # it was measured itself
        if abs(spacing / spacing_of(one.setting) - 1.0) < 1e-6:
            return None
    # The same line, read backwards: time at the spacing that the channel has.
    by_spacing = [Measured(one.curve, one.solver, one.setting, one.error, 1.0 / spacing_of(one.setting), one.time)
                  for one in curve]
    there = math.exp(along(by_spacing, math.log(1.0 / spacing), lambda one: one.time_spread))
    error = math.exp(along(curve, math.log(there), lambda one: one.error))
    spread = max(one.time_spread for one in curve)
    return Prediction(with_spacing(coarse.setting, spacing), error, factor, there, spread, False)


def curves_of(table: list, solver: str) -> list:
    """Curves of a solver, by rising time; a point that costs more and errs more than another has no say."""
    found = []
    for name in dict.fromkeys(one.curve for one in table if one.solver == solver):
        curve = sorted((one for one in table if one.curve == name), key=lambda one: one.time)
        kept = [one for k, one in enumerate(curve) if all(one.error < before.error for before in curve[:k])]
        if len(kept) >= 2:
            found.append((curve, kept))
    return found


def factor_of(curve: list, kept: list, floor: float) -> float:
    """The curve's left-out factor: of all its points if they fall in time, since what rises is noise, too."""
    distinct = [one for k, one in enumerate(curve) if k == 0 or one.time > curve[k - 1].time * 1.001]
    return max(left_out_factor(distinct), 1.0 + floor / min(one.error for one in kept))


def for_error(table: list, solver: str, wanted: float, floor: float, channel: list) -> Prediction | None:
    """The cheapest setting whose error, times its uncertainty, is `wanted` or less."""
    best = None
    for curve, kept in curves_of(table, solver):
        factor = factor_of(curve, kept, floor)
        candidates = [Prediction(one.setting, one.error, 1.0 + floor / one.error, one.time, one.time_spread, True)
                      for one in kept if one.error + floor <= wanted]
        for a, b in zip(kept, kept[1:]):
            aim = wanted / factor
            if b.error < aim < a.error and spacing_of(a.setting):
                share = math.log(a.error / aim) / math.log(a.error / b.error)
                time = a.time * (b.time / a.time) ** share
                candidates.append(at_time(kept, time, factor, channel, finer=True))
        for one in candidates:
            if one and (best is None or one.time < best.time):
                best = one
    return best


def for_time(table: list, solver: str, budget: float, floor: float, channel: list) -> Prediction | None:
    """The setting with the least error, uncertainty included, that stays within the budget with its own."""
    best = None
    for curve, kept in curves_of(table, solver):
        factor = factor_of(curve, kept, floor)
        for one in kept:
            if one.time * one.time_spread <= budget:
                found = Prediction(one.setting, one.error, 1.0 + floor / one.error, one.time, one.time_spread, True)
                if best is None or found.error * found.error_factor < best.error * best.error_factor:
                    best = found
        spread = max(one.time_spread for one in curve)
        if kept[0].time < budget / spread < kept[-1].time and spacing_of(kept[0].setting):
            found = at_time(kept, budget / spread, factor, channel, finer=False)
            if found and (best is None or found.error * found.error_factor < best.error * best.error_factor):
                best = found
    return best


def parse_error(text: str) -> float:
    match = re.fullmatch(r"\s*([0-9.]+)\s*(%?)\s*", text)
    if not match or float(match[1]) <= 0.0:
        raise NoAnswer(f"--error takes a positive part, such as 3% or 0.03, not '{text}'")
    return float(match[1]) * (0.01 if match[2] else 1.0)


def parse_time(text: str) -> float:
    match = re.fullmatch(r"\s*([0-9.]+)\s*(s|min|h)?\s*", text)
    if not match or float(match[1]) <= 0.0:
        raise NoAnswer(f"--time takes a positive time, such as 60s or 5min, not '{text}'")
    return float(match[1]) * {"s": 1.0, None: 1.0, "min": 60.0, "h": 3600.0}[match[2]]


def thicknesses(case: Path) -> list:
    """Least side of every body: a spacing between two whole numbers of layers is no neighbour of either. (The beam at
    4.29 mm, three and a half layers, is 10.5 % off, between 7.3 % at three and 2.3 % at four.)"""
    solids = tomllib.loads((case / "scene.toml").read_text()).get("solid", {})
    boxes = [solid["body"] for solid in solids.values() if "from" in solid.get("body", {})]
    return [min(quantity(to) - quantity(begin) for begin, to in zip(box["from"], box["to"])) for box in boxes]


def answer(case: Path, options: argparse.Namespace) -> dict:
    table = read_table(case / "records" / "cost_study.csv")
    about = json.loads((case / "records" / "cost_study.json").read_text())
    floor = max(about["truth_error"].values())
    sides = about["channel_m"] + thicknesses(case)
    found = {}
    for solver in plans.SOLVERS:
        if not any(one.solver == solver for one in table):
            continue
        found[solver] = (for_error(table, solver, parse_error(options.error), floor, sides) if options.error
                         else for_time(table, solver, parse_time(options.time), floor, sides))
    asked = f"error of {parse_error(options.error):.2%}" if options.error else f"budget of {parse_time(options.time):g} s"
    commits = "; ".join(f"{solver} at {', '.join(c[:7] for c in those)}" for solver, those in about["commits"].items())
    print(f"{about['title']}, {asked}; measured on {', '.join(about['processor'])}, one thread, {commits}\n")
    for solver, one in found.items():
        least = min(m.error for m in table if m.solver == solver)
        reach = f"no setting that was measured does (the least error is {least:.2%})" if options.error else \
            "no setting that was measured is as cheap"
        print(f"  {solver}: {one or reach}")
    both = [one for one in found.values() if one]
    if len(both) == 2:
        ratio = both[0].time / both[1].time
        print(f"\n  {'the particles take' if ratio > 1.0 else 'the finite elements take'} {max(ratio, 1 / ratio):.3g}"
              " times as long")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(prog="./sprung recommend", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path)
    wish = parser.add_mutually_exclusive_group(required=True)
    wish.add_argument("--error")
    wish.add_argument("--time")
    options = parser.parse_args()
    try:
        found = answer(options.case.resolve(), options)
    except NoAnswer as fault:
        say(str(fault))
        return WRONG_USE
    return 0 if any(found.values()) else NOT_REACHED


if __name__ == "__main__":
    sys.exit(main())
