#!/usr/bin/env python3
"""recommend.py CASE-FOLDER (--error 3% | --time 60s | --check OTHER-CASE-FOLDER)

Reads the kept table of the case's cost study (CASE-FOLDER/records/cost_study.csv) and names, for each solver, the
cheapest setting that reaches an error, or the most accurate one within a budget of processor time.

The prediction is a straight line in log error and log time through each curve's neighbouring points. Its uncertainty
is measured, not assumed: every inner point of the curve is predicted from the others, as if it had not been run, and
the largest factor between the prediction and what was measured is the factor given (at least the spread of repeats,
and at least the truth's own error). A setting is named only if its error, times that factor, still reaches what is
asked. Of a setting that was measured the error is known for that case; on another problem like it expect it within the
same factor. --check holds that against the kept table of another case, which has no part in the prediction: every
setting that both tables have.

Exit codes: 0 a setting is named, or every checked one lies within its prediction; 1 none that was measured reaches it,
or one lies outside; 2 wrong use.
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
    elsewhere: float = 1.0  # factor within which a problem like this one should lie

    def __str__(self) -> str:
        how = "between two that were measured"
        if self.measured:
            how = (f"measured\n    on another problem like it expect {self.error / self.elsewhere:.2%} to "
                   f"{self.error * self.elsewhere:.2%}")
        return (f"{self.setting}\n    error {self.error:.2%} ({self.error / self.error_factor:.2%} to "
                f"{self.error * self.error_factor:.2%}), processor time {self.time:.3g} s "
                f"({self.time / self.time_factor:.3g} to {self.time * self.time_factor:.3g} s); {how}")


def kept_table(case: Path) -> str:
    file = case / "records" / "cost_study.csv"
    if not file.exists():
        raise NoAnswer(f"there is no {file}; ./sprung study cost {case.name} --accept REASON makes it")
    return file.read_text()


def read_table(file: Path) -> list[Measured]:
    rows = csv.DictReader(line for line in kept_table(file.parents[1]).splitlines() if not line.startswith("#"))
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
    """The setting at another spacing, which divides the scene's own channel: one made to fit a spacing goes."""
    setting = re.sub(r" ?domain\.channel=\{[^}]*\}", "", setting)
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
        candidates = [Prediction(one.setting, one.error, 1.0 + floor / one.error, one.time, one.time_spread, True,
                                 factor)
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
                found = Prediction(one.setting, one.error, 1.0 + floor / one.error, one.time, one.time_spread, True,
                                   factor)
                if best is None or found.error * found.error_factor < best.error * best.error_factor:
                    best = found
        spread = max(one.time_spread for one in curve)
        if kept[0].time < budget / spread < kept[-1].time and spacing_of(kept[0].setting):
            found = at_time(kept, budget / spread, factor, channel, finer=False)
            if found and (best is None or found.error * found.error_factor < best.error * best.error_factor):
                best = found
    return best


NUMBER = r"\s*([0-9]+\.?[0-9]*(?:[eE][-+]?[0-9]+)?|\.[0-9]+)\s*"


def parse_error(text: str) -> float:
    match = re.fullmatch(NUMBER + r"(%?)\s*", text)
    if not match or float(match[1]) <= 0.0:
        raise NoAnswer(f"--error takes a positive part, such as 3% or 0.03, not '{text}'")
    return float(match[1]) * (0.01 if match[2] else 1.0)


def parse_time(text: str) -> float:
    match = re.fullmatch(NUMBER + r"(s|min|h)?\s*", text)
    if not match or float(match[1]) <= 0.0:
        raise NoAnswer(f"--time takes a positive time, such as 60s or 5min, not '{text}'")
    return float(match[1]) * {"s": 1.0, None: 1.0, "min": 60.0, "h": 3600.0}[match[2]]


def boxes(case: Path) -> list:
    """Bodies of the case's scene that are boxes: (corner, opposite corner) in m."""
    solids = tomllib.loads((case / "scene.toml").read_text()).get("solid", {})
    return [tuple([quantity(x) for x in solid["body"][end]] for end in ("from", "to"))
            for solid in solids.values() if "from" in solid.get("body", {})]


def thicknesses(case: Path) -> list:
    """Least side of every body: a spacing between two whole numbers of layers is no neighbour of either. (The beam at
    4.29 mm, three and a half layers, is 10.5 % off, between 7.3 % at three and 2.3 % at four.)"""
    return [min(b - a for a, b in zip(low, high)) for low, high in boxes(case)]


def graded(case: Path, about: dict, wanted: float) -> str:
    """On paper: what finer particles near the body alone would save, where the motion of the body is what asks for them.

    Far away the coarsest spacing at which every other quantity reaches the error; within twice the body's thickness of
    it the coarsest at which all do. Time as the number of particles, at the finer spacing's step. "" where nothing is to
    be had.
    """
    rows = csv.DictReader(line for line in (case / "records" / "cost_study.csv").read_text().splitlines()
                          if not line.startswith("#"))
    points = [(spacing_of(row["setting"]), row) for row in rows if row["curve"] == "spacing" and row["error"]]
    bodies, channel = boxes(case), about["channel_m"]
    moved = [q for q, one in about["quantities"].items() if one["kind"] == "displacement"]
    if not bodies or not moved or len(channel) != 2:
        return ""

    def coarsest(names) -> float | None:
        fit = [h for h, row in points if all(float(row[f"error_{q}"]) + about["truth_error"][q] <= wanted for q in names)]
        return max(fit, default=None)

    near, far = coarsest(about["quantities"]), coarsest([q for q in about["quantities"] if q not in moved])
    if near is None or far is None or far <= near * 1.001:
        return ""
    zone = 0.0
    for low, high in bodies:
        reach = 2.0 * min(b - a for a, b in zip(low, high))
        sides = [min(b + reach, side) - max(a - reach, 0.0) for a, b, side in zip(low, high, channel)]
        zone += sides[0] * sides[1]
    area = channel[0] * channel[1]
    part = (zone + (area - zone) * (near / far) ** 2) / area
    return (f"on paper, {1e3 * near:g} mm within {1e3 * reach:g} mm of the body and {1e3 * far:g} mm elsewhere would do with "
            f"{part:.2f} of the particles and, at the same step, of the time: a factor of {1.0 / part:.2g}")


def at_equal_spacing(case: Path) -> str:
    """The plan's pair of one point of either solver at the same spacing; "" where there is none or it was not run."""
    rows = {f"{row['curve']}.{row['point']}": row for row in csv.DictReader(
        line for line in kept_table(case).splitlines() if not line.startswith("#")) if row["error"]}
    for name, curve in plans.read(case).table["curve"].items():
        one, other = rows.get(f"{name}.0"), rows.get(curve.get("twin", ""))
        if one and other:
            ratio = float(other["processor_seconds"]) / float(one["processor_seconds"])
            return (f"at equal spacing ({other['setting']}; {curve['says']}): {other['solver']} "
                    f"{float(other['processor_seconds']):.3g} s for {float(other['error']):.2%}, {one['solver']} "
                    f"{float(one['processor_seconds']):.3g} s for {float(one['error']):.2%}: the particles take {ratio:.2g} "
                    "times as long")
    return ""


def check(case: Path, other: Path) -> bool:
    """Every setting that both tables have: the case's prediction for it, with its uncertainty, beside the other's measurement."""
    tables, plan = {}, {}
    for one in (case, other):
        plan[one] = plans.read(one)
        rows = csv.DictReader(line for line in kept_table(one).splitlines() if not line.startswith("#"))
        tables[one] = {(row["curve"], int(row["point"])): row for row in rows if row["error"]}
    about = json.loads((case / "records" / "cost_study.json").read_text())
    floor = {one: max(json.loads((one / "records" / "cost_study.json").read_text())["truth_error"].values())
             for one in (case, other)}
    measured = read_table(case / "records" / "cost_study.csv")
    factors = {curve[0].curve: factor_of(curve, kept, floor[case])
               for solver in plans.SOLVERS for curve, kept in curves_of(measured, solver)}
    print(f"{other.name} by the table of {case.name}: {about['title']}\n")
    fixed = {one for curve in plan[other].table["curve"].values() for one in curve.get("fixed", [])}
    within = found = 0
    for point in plan[other].points:
        row = tables[other].get((point.curve, point.number))
        twin = next((p for p in plan[case].points if p.solver == point.solver and p.curve in factors and
                     set(p.overrides) == set(point.overrides) - fixed), None)
        known = tables[case].get((twin.curve, twin.number)) if twin else None
        if row is None or known is None:
            continue
        said, factor, got = float(known["error"]), factors[twin.curve], float(row["error"])
        fits = said / factor - floor[other] <= got <= said * factor + floor[other]
        time = float(row["processor_seconds"]) / float(known["processor_seconds"])
        found, within = found + 1, within + fits
        print(f"  {point.solver}: {' '.join(twin.overrides)}\n    said {said:.2%} ({said / factor:.2%} to "
              f"{said * factor:.2%}), measured {got:.2%} +- {floor[other]:.2%}: {'within' if fits else 'OUTSIDE'}; "
              f"processor time {time:.2f} of what was said")
    if found == 0:
        raise NoAnswer(f"{other.name} and {case.name} have no measured setting in common")
    print(f"\n  {within} of {found} within the prediction's uncertainty")
    return within == found


def answer(case: Path, options: argparse.Namespace) -> dict:
    table = read_table(case / "records" / "cost_study.csv")
    about = json.loads((case / "records" / "cost_study.json").read_text())
    floor = max(about["truth_error"].values())
    sides = about["channel_m"] + (thicknesses(case) if (case / "scene.toml").exists() else [])
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
    equal = at_equal_spacing(case)
    print(f"\n  {equal}" if equal else "", end="\n" if equal else "")
    if options.error and found.get("particles"):
        saving = graded(case, about, parse_error(options.error))
        print(f"\n  {saving}" if saving else "", end="\n" if saving else "")
    return found


def values_joined(words: list) -> list:
    """--error and --time with the word after them: a negative one is a wrong value, not another option."""
    joined = []
    for word in words:
        if joined and joined[-1] in ("--error", "--time") and re.match(r"-[0-9.]", word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def main() -> int:
    parser = argparse.ArgumentParser(prog="./sprung recommend", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path)
    wish = parser.add_mutually_exclusive_group(required=True)
    wish.add_argument("--error")
    wish.add_argument("--time")
    wish.add_argument("--check", type=Path)
    options = parser.parse_args(values_joined(sys.argv[1:]))
    try:
        if options.check:
            return 0 if check(options.case.resolve(), options.check.resolve()) else NOT_REACHED
        found = answer(options.case.resolve(), options)
    except (NoAnswer, plans.WrongPlan) as fault:
        say(str(fault))
        return WRONG_USE
    return 0 if any(found.values()) else NOT_REACHED


if __name__ == "__main__":
    sys.exit(main())
