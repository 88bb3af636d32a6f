#!/usr/bin/env python3
"""fronts.py [--error 3%]: every kept cost study in one table, Markdown, from validation/*/records/cost_study.csv.

A row a case: of either solver the points of its main curve (recommended by spacing; mesh and step together), the errors
and processor times that they span, and the cheapest measured setting within the error, the truth's own error added; the
ratio of the two times. Runs nothing.
"""

import argparse
import json
import sys
from pathlib import Path

import plan as plans
import recommend

from quantities import ROOT
from verify import say  # noqa: I001  (quantities.py made the driver known)

WRONG_USE = 2
MAIN = {"particles": "spacing", "reference": "reference"}


def percent(value: float) -> str:
    return f"{100.0 * value:.2g} %" if value >= 1e-6 else f"{value:.0e}"


def seconds(value: float) -> str:
    return f"{value:.3g} s"


def span(curve: list) -> str:
    if not curve:
        return "none"
    errors, times = [one.error for one in curve], [one.time for one in curve]
    return (f"{len(curve)}: {percent(max(errors))} to {percent(min(errors))}, {seconds(min(times))} to "
            f"{seconds(max(times))}")


def cheapest(table: list, solver: str, wanted: float, floor: float):
    fit = [one for one in table if one.solver == solver and one.error + floor <= wanted]
    return min(fit, key=lambda one: one.time, default=None)


def row(case: Path, wanted: float) -> str:
    table = recommend.read_table(case / "records" / "cost_study.csv")
    about = json.loads((case / "records" / "cost_study.json").read_text())
    floor = max(about["truth_error"].values())
    found = {solver: cheapest(table, solver, wanted, floor) for solver in plans.SOLVERS}
    cells = [about["title"]]
    for solver in plans.SOLVERS:
        cells.append(span([one for one in table if one.solver == solver and one.curve == MAIN[solver]]))
        one = found[solver]
        cells.append(f"{seconds(one.time)} ({percent(one.error)}; {one.setting.replace('reference_fem.', '')})" if one else "none")
    both = all(found.values())
    ratio = found["particles"].time / found["reference"].time if both else 0.0
    cells += [percent(floor) if floor > 0.0 else "exact", f"{ratio:.2g}" if both else "",
              ", ".join(sorted({commit[:7] for those in about["commits"].values() for commit in those}))]
    return "| " + " | ".join(cells) + " |"


def main() -> int:
    parser = argparse.ArgumentParser(prog="./sprung recommend all", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--error", default="3%")
    options = parser.parse_args(recommend.values_joined(sys.argv[1:]))
    try:
        wanted = recommend.parse_error(options.error)
    except recommend.NoAnswer as fault:
        say(str(fault))
        return WRONG_USE
    within = f"cheapest within {options.error}"
    print(f"| case | particles: points, errors, times | {within} | finite elements: the same | {within} | truth's own error "
          "| particles over elements | commit |\n|---|---|---|---|---|---|---|---|")
    for file in sorted((ROOT / "validation").glob("*/records/cost_study.csv")):
        print(row(file.parents[1], wanted))
    return 0


if __name__ == "__main__":
    sys.exit(main())
