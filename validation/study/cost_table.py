#!/usr/bin/env python3
"""cost_table.py CASE-FOLDER --out DIR [--truth DIR] [--quick] [--accept REASON]: the table of a cost study.

Reads the answers in DIR/points, and the truth's levels, and writes DIR/cost.csv, one row a point, and DIR/cost.json,
what made it. Repeats of one point must have the same numbers bit for bit; that they differ is an error, exit code 6.
--accept keeps both as CASE-FOLDER/records/cost_study.csv and .json.
"""

import argparse
import csv
import io
import json
import math
import statistics
import sys
import tomllib
from pathlib import Path

import numpy as np

import plan as plans
import quantities

from verify import say, write_whole  # noqa: I001  (quantities.py made the driver known)

WRONG_USE, NO_TABLE = 2, 6
SAFETY = 1.25  # Roache's, as in the reference's error bar


class NoTable(Exception):
    pass


# ------------------------------------------------------------------------------------------------- truth


def truth_of(plan: plans.Plan, folder: Path) -> tuple[dict, dict]:
    """(true numbers by quantity, the truth's own error by quantity, as an error of that quantity)."""
    samples = plan.quantities
    if plan.block:
        strain = quantities.strain_under_pull(float(plan.truth["exact"]))
        return {q: np.array([[strain]]) for q in samples}, dict.fromkeys(samples, 0.0)
    if "exact" in plan.truth:
        name = plan.truth["exact"]
        return ({q: quantities.true_energy(name, plan.scene("particles"), one) for q, one in samples.items()},
                dict.fromkeys(samples, 0.0))
    if "published" in plan.truth:
        # A value is known to half a unit of its last printed digit.
        values = {q: np.array([[float(plan.truth["published"][q])]]) for q in samples}
        return values, {q: float(plan.truth.get("error", 0.0)) for q in samples}
    levels = [json.loads((folder / f"level_{k}.json").read_text()) for k in range(3)]
    for level in levels:
        if level["missing"]:
            raise NoTable(f"the truth's {level['name']} lacks numbers: {level['missing']}")
    true, floor = {}, {}
    for q, one in samples.items():
        coarse, middle, fine = (np.array(level["numbers"][q]) for level in levels)
        true[q], _ = quantities.extrapolated(coarse, middle, fine)
        floor[q] = SAFETY * quantities.error(one, fine, true[q])
    return true, floor


# ------------------------------------------------------------------------------------------------- points


def same_numbers(runs: list) -> bool:
    return all(run["numbers"] == runs[0]["numbers"] and run["steps"] == runs[0]["steps"] for run in runs)


def row_of(point: plans.Point, runs: list, plan: plans.Plan, true: dict) -> dict:
    """One row: what was asked, the errors, and medians of the cost with least and most."""
    row = {"curve": point.curve, "point": point.number, "solver": point.solver, "setting": " ".join(point.overrides),
           "repeats": len(runs), "outcome": runs[0]["outcome"].replace(",", ";")}
    whole = [run for run in runs if "processor_seconds" in run]
    if whole and not same_numbers(whole):
        raise NoTable(f"{point.name}: its runs differ in their numbers; a run must not depend on when it is made")
    errors = {q: quantities.error(one, np.array(runs[0]["numbers"][q]), true[q])
              for q, one in plan.quantities.items() if q in runs[0]["numbers"]}
    row |= {f"error_{q}": f"{errors[q]:.6g}" if q in errors else "" for q in plan.quantities}
    row["error"] = f"{max(errors.values()):.6g}" if len(errors) == len(plan.quantities) else ""
    if not whole:
        return row
    for name in ("processor_seconds", "wall_seconds"):
        values = [run[name] for run in whole]
        row |= {name: f"{statistics.median(values):.4g}", f"{name}_least": f"{min(values):.4g}",
                f"{name}_most": f"{max(values):.4g}"}
    row |= {"memory_MB": f"{statistics.median(run['peak_memory_bytes'] for run in whole) / 1e6:.4g}",
            "unknowns": whole[0]["unknowns"], "steps": whole[0]["steps"],
            "time_step_s": f"{whole[0]['time_step']:.6g}"}
    return row


def own_error(plan: plans.Plan, runs: list, limit: list) -> str:
    """Largest distance of a point from its curve's limit, as an error of each quantity; "" where it has none."""
    if not limit or set(limit[0]["numbers"]) != set(plan.quantities) or set(runs[0]["numbers"]) != set(plan.quantities):
        return ""
    own = max(quantities.error(one, np.array(runs[0]["numbers"][q]), np.array(limit[0]["numbers"][q]))
              for q, one in plan.quantities.items())
    return f"{own:.6g}" if own > 0.0 else ""


def rows_of(plan: plans.Plan, out: Path, true: dict) -> tuple[list, list]:
    rows, made = [], []

    def runs_of(name: str, repeats: int) -> list:
        files = [out / "points" / f"{name}.r{k}.json" for k in range(1, repeats + 1)]
        return [json.loads(file.read_text()) for file in files if file.exists()]

    for point in plan.points:
        runs, limit = runs_of(point.name, point.repeats), plan.table["curve"][point.curve].get("limit")
        if runs:
            rows.append(row_of(point, runs, plan, true))
            if limit is not None:
                rows[-1]["error_own"] = own_error(plan, runs, runs_of(f"{point.curve}.{limit}", 1))
        else:  # a study under way, or kept before its end: the table says what it lacks
            rows.append({"curve": point.curve, "point": point.number, "solver": point.solver,
                         "setting": " ".join(point.overrides), "repeats": 0, "outcome": "not run", "error": ""})
        made += runs
    if not made:
        raise NoTable(f"there is no answer in {out / 'points'}")
    return rows, made


def manifest(plan: plans.Plan, made: list, spans: dict, truth: tuple, reason: str) -> dict:
    true, floor = truth
    whole = [run for run in made if "processor_seconds" in run]

    def one(key):
        return sorted({str(run[key]) for run in whole})

    loads = [run["load_at_start"] for run in whole if run.get("load_at_start") is not None]
    return {"format": "sprung cost study 1", "accepted_because": reason, "case": plan.case.name,
            "title": plan.table["title"], "command": f"./sprung study cost {plan.case.name}",
            "commits": {solver: sorted({run["commit"] for run in whole if run["solver"] == solver})
                        for solver in sorted({run["solver"] for run in whole})},
            "clean": one("clean"), "processor": one("processor"), "threads": one("threads"),
            "runs": len(whole), "started": [min(run["started"] for run in whole), max(run["started"] for run in whole)],
            "load_at_start": {"least": min(loads), "median": statistics.median(loads), "most": max(loads)}
            if loads else None,
            "truth": plan.truth, "truth_error": floor, "channel_m": channel_of(plan),
            "true": {q: values.tolist() for q, values in true.items()}, "quantities": plan.quantities,
            "curves": {name: curve["says"] for name, curve in plan.table["curve"].items()}, "spans": spans,
            "scaling": {curve: one for curve in plan.table["curve"] if (one := scaling(curve, made))},
            "phases": {run["name"]: run["phases"] for run in whole if run["repeat"] == 1}}


def channel_of(plan: plans.Plan) -> list:
    """Lengths of the channel's sides: a spacing has to divide them. None of a block."""
    if plan.block:
        return []
    box = tomllib.loads(plan.scene("particles").read_text())["domain"]["channel"]
    return [round(quantities.quantity(to) - quantities.quantity(begin), 12) for begin, to in zip(box["from"], box["to"])]


def as_csv(plan: plans.Plan, rows: list, floor: dict) -> str:
    """Columns are the same for every row; the first lines say what the numbers are."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    text.write(f"# Cost of {plan.case.name}: {plan.table['says']}; made by ./sprung study cost {plan.case.name}, "
               "what made it stands in the JSON file beside it.\n")
    text.write("# The truth's own error, below which no error means anything: "
               + "; ".join(f"{q} {value:.3g}" for q, value in floor.items()) + "\n")
    writer = csv.DictWriter(text, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


# ------------------------------------------------------------------------------------------------- scaling


def power(x: list, y: list) -> tuple[float, float, float]:
    """(exponent, its standard error, factor) of y = factor x^exponent, least squares in the logarithms."""
    a, b = np.log(x), np.log(y)
    design = np.column_stack([a, np.ones_like(a)])
    solution, *_ = np.linalg.lstsq(design, b, rcond=None)
    rest = b - design @ solution
    spread = math.sqrt(float(rest @ rest) / max(1, len(x) - 2) / float(np.sum((a - a.mean()) ** 2)))
    return float(solution[0]), spread, math.exp(float(solution[1]))


FAR = (1e6, 1e9)  # unknowns to which the fit is carried on paper
LEAST_SECONDS = 1.0  # shorter runs measure the start of the program


def scaling(curve: str, made: list) -> dict | None:
    """How one curve's cost grows with its unknowns: exponents of the whole and of each phase, carried to FAR.

    On paper, and only as good as its assumptions: the same scene refined, so that steps grow with resolution as they
    did; iterations of the linear solves growing as they did over the range that was measured; one thread; memory
    traffic per unknown as it was (a state that leaves the caches is dearer, and 10^9 unknowns fit no single machine).
    """
    runs = sorted((run for run in made if run["name"].split(".")[0] == curve and run.get("repeat") == 1
                   and run.get("outcome") == "finished" and run["processor_seconds"] >= LEAST_SECONDS), key=lambda run: run["unknowns"])
    counts = [run["unknowns"] for run in runs]
    if len(set(counts)) < 3:
        return None
    exponent, error, factor = power(counts, [run["processor_seconds"] for run in runs])
    memory = (runs[-1]["peak_memory_bytes"] - runs[0]["peak_memory_bytes"]) / (counts[-1] - counts[0])
    names = [name for name in runs[-1]["phases"] if all(run["phases"].get(name, 0.0) > 0.0 for run in runs)]
    return {"unknowns": [counts[0], counts[-1]], "exponent": exponent, "standard_error": error,
            "bytes_per_unknown": memory,
            "phases": {name: {"exponent": power(counts, [run["phases"][name] for run in runs])[0],
                              "share_of_finest": runs[-1]["phases"][name] / sum(runs[-1]["phases"].values())}
                       for name in names},
            "on_paper": {f"{far:.0e}": {"processor_seconds": factor * far**exponent, "bytes": memory * far} for far in FAR}}


def scaling_text(curve: str, one: dict) -> str:
    lines = [f"{curve}: processor time grows as unknowns^{one['exponent']:.2f} (standard error {one['standard_error']:.2f}),"
             f" from {one['unknowns'][0]} to {one['unknowns'][1]}; {one['bytes_per_unknown']:.0f} bytes an unknown"]
    lines += [f"  {name:32} {phase['share_of_finest']:5.1%} of the finest, unknowns^{phase['exponent']:.2f}"
              for name, phase in one["phases"].items()]
    lines += [f"  on paper, {far} unknowns: {paper['processor_seconds']:.2g} s ({paper['processor_seconds'] / 3600:.2g} h),"
              f" {paper['bytes'] / 1e9:.2g} GB" for far, paper in one["on_paper"].items()]
    return "\n".join(lines)


# ------------------------------------------------------------------------------------------------- answers


def front(rows: list, solver: str) -> list:
    """The rows of a solver that no other of its rows beats in both error and processor time, cheap to dear."""
    best, least = [], math.inf
    usable = [row for row in rows if row["solver"] == solver and row.get("error") and row.get("processor_seconds")]
    for row in sorted(usable, key=lambda r: (float(r["processor_seconds"]), float(r["error"]))):
        if float(row["error"]) < least:
            best.append(row)
            least = float(row["error"])
    return best


def spans_of(plan: plans.Plan, rows: list) -> dict:
    """Of every curve: how many points have an error, over what factor, the least, and, if that is less than five over a
    decade, why; the same of the distance from the curve's own limit."""
    found = {}
    for name, curve in plan.table["curve"].items():
        own = [row for row in rows if row["curve"] == name]
        one = {}
        for key in ("error", "error_own"):
            values = [float(row[key]) for row in own if row.get(key)]
            if values:
                one[key] = {"points": len(values), "least": min(values), "factor": max(values) / min(values)}
        whole = any(part["points"] >= 5 and part["factor"] >= 10.0 for part in one.values())
        found[name] = one | {"five_over_a_decade": whole}
        if "floor" in curve:
            found[name]["floor"] = curve["floor"]
    return found


def spans_text(spans: dict) -> str:
    lines = []
    for name, one in spans.items():
        parts = [f"{one[key]['points']} points over a factor {one[key]['factor']:.3g}, the least {100.0 * one[key]['least']:.3g} %{of}"
                 for key, of in (("error", ""), ("error_own", " from the curve's own limit")) if key in one]
        why = "" if one["five_over_a_decade"] else f"; no decade: {one.get('floor', 'no reason is given')}"
        lines.append(f"  {name}: {'; '.join(parts) or 'no point has an error'}{why}")
    return "\n".join(lines)


def summary(plan: plans.Plan, rows: list, floor: dict) -> str:
    lines = [plan.table["title"], ""]
    for solver in plans.SOLVERS:
        best = front(rows, solver)
        if not best:
            continue
        span = float(best[0]["error"]) / float(best[-1]["error"])
        lines.append(f"{solver}: {len(best)} points on the front over a factor {span:.3g} of error"
                     + ("" if len(best) >= 5 and span >= 10 else "; not five points over a decade"))
        lines += [f"  {100.0 * float(row['error']):8.3g} %  {float(row['processor_seconds']):8.3g} s  "
                  f"{row['curve']}: {row['setting']}" for row in best]
    lines.append(f"the truth's own error: {max(floor.values()):.2%}")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--truth", type=Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--accept", metavar="REASON")
    options = parser.parse_args()
    plan = plans.read(options.case.resolve(), options.quick)
    try:
        if options.accept is not None and (options.quick or not options.accept.strip()):
            say("--accept keeps a whole study, not a quick one, and says why: --accept REASON")
            return WRONG_USE
        true, floor = truth_of(plan, options.truth or options.out / "truth")
        rows, made = rows_of(plan, options.out, true)
    except (NoTable, quantities.Missing, FileNotFoundError) as fault:
        say(str(fault))
        return NO_TABLE
    table = as_csv(plan, rows, floor)
    about = manifest(plan, made, spans_of(plan, rows), (true, floor), options.accept or "")
    about_text = json.dumps(about, indent=1) + "\n"
    if options.accept is not None and about["clean"] != ["yes"]:
        say("--accept keeps what a clean commit made; these runs were made with changes that are not committed")
        return WRONG_USE
    write_whole(options.out / "cost.csv", table)
    write_whole(options.out / "cost.json", about_text)
    if options.accept is not None:
        kept = plan.case / "records"
        kept.mkdir(exist_ok=True)
        write_whole(kept / "cost_study.csv", table)
        write_whole(kept / "cost_study.json", about_text)
    print(summary(plan, rows, floor), end="")
    print(spans_text(about["spans"]))
    for curve, one in about["scaling"].items():
        if curve in ("spacing", "reference"):
            print("\n" + scaling_text(curve, one))
    return 0


if __name__ == "__main__":
    sys.exit(main())
