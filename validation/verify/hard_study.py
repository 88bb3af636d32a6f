#!/usr/bin/env python3
"""hard_study.py --program sprung-sph --out DIR [--row NAME ...] [--accept REASON]: the hard cases, one row each.

Runs every row of validation/hard/*/hard.toml, measures its figures, judges them, and leaves DIR/hard.json and the table
DIR/hard.txt. What the same program has answered already is not run again; what was stopped is taken up where it stands.

hard.toml:
  title, why                 what the row is; what breaks, and what passing means
  shows                      in a few words, for the table
  [run.NAME]                 scene (else scene.toml), overrides; ends: finished (default), refused or stopped;
                             of_row: the row that makes this very run;
                             says: a text that a refusal, a warning or a stop must hold
  for.WORD = [values]        with a [run.NAME] that holds {WORD} in its overrides: a run for each value, NAME-VALUE
  [figure.NAME]              says, kind and what that kind needs (hard_measures.py); of: names of runs, * at the end
                             stands for the rest (default all that should finish); least or most, and because
  [limit]                    where: the method's limit as found, in words; cause; runs: those beyond it (as in of).
                             They are measured and shown, and asked only to end by themselves, with a message
  held_by                    instead of runs: where the row is held, a test or a kept table

Verdict of a row: passes; the method's limit (all else passes); FAILS; not judged (no record).
Exit codes: 0 no row fails, 1 one does or was not judged, 2 wrong use.
"""

import argparse
import itertools
import json
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import hard_measures
from measures import Missing
from scene import SceneMismatch
from verify import FAIL, NOT_JUDGED, PASS, ROOT, WRONG_USE, Runner, WrongUse, facts, number, say, say_point, write_whole

from record import Record  # noqa: I001  (scene.py made the reader known)

ROWS = ROOT / "validation" / "hard"
LIMIT = "the method's limit"
ENDS = ("finished", "refused", "stopped")


def runs_of(row: dict) -> dict:
    """[run.NAME] with its {WORD}s filled in: a dictionary by name."""
    runs = {}
    for name, run in row.get("run", {}).items():
        text = json.dumps(run)
        words = [word for word in row.get("for", {}) if "{" + word + "}" in text]
        for values in itertools.product(*(row["for"][word] for word in words)):
            filled, full = text, name
            for word, value in zip(words, values):
                filled, full = filled.replace("{" + word + "}", str(value)), f"{full}-{value}".replace(" ", "")
            runs[full] = json.loads(filled)
    return runs


def chosen(patterns: list, names: list) -> list:
    return [name for name in names
            if any(name == p or (p.endswith("*") and name.startswith(p[:-1])) for p in patterns)]


def read_row(folder: Path) -> dict:
    """hard.toml, checked for what the driver relies on."""
    file = folder / "hard.toml"
    row = tomllib.loads(file.read_text())
    for key in ("title", "why", "shows"):
        if not row.get(key):
            raise WrongUse(f"{file}: lacks '{key}'")
    row["name"], row["folder"], row["runs"] = folder.name, folder, runs_of(row)
    if not row["runs"] and not row.get("held_by"):
        raise WrongUse(f"{file}: has neither runs nor held_by")
    for name, run in row["runs"].items():
        if run.get("ends", "finished") not in ENDS:
            raise WrongUse(f"{file}: [run.{name}] ends: one of {', '.join(ENDS)}, not {run['ends']!r}")
    for name, figure in row.get("figure", {}).items():
        where = f"{file}: [figure.{name}]"
        if figure.get("kind") not in hard_measures.KINDS:
            raise WrongUse(f"{where}: kind must be one of {', '.join(hard_measures.KINDS)}")
        if not ({"says", "because"} <= set(figure)) or not {"least", "most"} & set(figure):
            raise WrongUse(f"{where} needs says, because, and least or most")
        figure["folder"] = folder
    beyond = row.get("limit", {})
    if beyond and not {"where", "cause", "runs"} <= set(beyond):
        raise WrongUse(f"{file}: [limit] has where, cause and runs")
    return row


class Study:
    def __init__(self, options: argparse.Namespace):
        self.program, self.out = options.program, options.out
        self.runner = Runner(options.program, 1, options.time_limit)

    def ended(self, row: dict, name: str, run: dict) -> dict:
        """Runs one run; how it ended, and what of it is known."""
        folder = self.out / run.get("of_row", row["name"]) / name
        scene = row["folder"] / run.get("scene", "scene.toml")
        overrides = run.get("overrides", [])
        if run.get("ends") == "refused" or "says" in run:
            checked = subprocess.run([self.program, "check", scene, *overrides], capture_output=True, text=True, check=False)
            message = (checked.stdout + checked.stderr).strip().replace(str(row["folder"]) + "/", "").replace(
                str(ROOT) + "/", "")
            if run.get("ends") == "refused" or checked.returncode != 0:
                return {"outcome": "refused" if checked.returncode == 1 else f"exit code {checked.returncode}",
                        "message": message}
            if run["says"] not in message:
                return {"outcome": f"not told {run['says']!r}", "message": message}
        fault = self.runner.run(f"{row['name']} {name}", scene.resolve(), overrides, folder)
        if fault:
            return {"outcome": fault}
        record = Record(folder, name)
        outcome = record.manifest["outcome"]
        return {**facts(record, folder), "folder": str(folder.relative_to(self.out)), "record": record,
                "message": outcome if outcome != "finished" else "",
                "outcome": "stopped" if outcome.startswith("stopped") else outcome}

    def row(self, row: dict) -> dict:
        ends = {name: self.ended(row, name, run) for name, run in row["runs"].items()}
        beyond = chosen(row.get("limit", {}).get("runs", []), list(row["runs"]))
        verdicts = [judge_end(name, run, ends[name], name in beyond) for name, run in row["runs"].items()]
        figures = {name: measure(figure, row, ends, beyond) for name, figure in row.get("figure", {}).items()}
        verdicts += [figure["verdict"] for figure in figures.values()]
        if FAIL in verdicts:
            verdict = FAIL
        elif NOT_JUDGED in verdicts:
            verdict = NOT_JUDGED
        else:
            verdict = LIMIT if row.get("limit") else "passes"
        for end in ends.values():
            end.pop("record", None)
        return {"title": row["title"], "why": row["why"], "shows": row["shows"], "held_by": row.get("held_by"),
                "limit": row.get("limit"), "runs": ends, "figures": figures, "verdict": verdict}


def judge_end(name: str, run: dict, end: dict, beyond: bool) -> str:
    """How a run ended against how it should; beyond the limit any end with a message will do."""
    if beyond:
        return PASS if end["outcome"] in ENDS and (end["outcome"] == "finished" or end["message"]) else FAIL
    if end["outcome"] not in ENDS:
        return NOT_JUDGED if "time limit" in end["outcome"] else FAIL
    held = run.get("says", "") in end.get("message", "") or end["outcome"] == "finished"
    return PASS if end["outcome"] == run.get("ends", "finished") and held else FAIL


def measure(figure: dict, row: dict, ends: dict, beyond: list) -> dict:
    """The figure of every run that it is of, and the worst of those within the limit, judged."""
    names = [name for name, run in row["runs"].items() if run.get("ends", "finished") == "finished"]
    names = chosen(figure.get("of", ["*"]), names)
    values, missing, curves, axes = {}, {}, [], ("", "")
    for name in names:
        try:
            if "record" not in ends[name]:
                raise Missing(ends[name]["outcome"])
            finding = hard_measures.measure(ends[name]["record"], figure)
        except (Missing, SceneMismatch, ValueError) as cause:
            missing[name] = str(cause)
            continue
        values[name] = finding.value
        if finding.axis:
            curves.append({"label": name, "axis": finding.axis, "found": finding.found})
            axes = finding.axes
    within = {name: value for name, value in values.items() if name not in beyond}
    result = {"says": figure["says"], "kind": figure["kind"], "values": values, "missing": missing, "curves": curves,
              "axes": axes, "because": figure["because"]}
    low, high = figure.get("least"), figure.get("most")
    result["limit"] = " and ".join(f"{sign} {bound:g}" for sign, bound in ((">=", low), ("<=", high)) if bound is not None)
    if not within or any(name not in beyond for name in missing):
        return {**result, "value": None, "verdict": NOT_JUDGED}
    worst = (min if high is None else max)(within.values())
    good = all((low is None or v >= low) and (high is None or v <= high) for v in within.values())
    return {**result, "value": worst, "verdict": PASS if good else FAIL}


# --------------------------------------------------------------------------------------------------- table


def table(result: dict) -> str:
    lines = []
    for name, row in result["rows"].items():
        lines += [f"{name}: {row['title']}: {row['verdict']}", f"  {row['why']}"]
        if row["held_by"]:
            lines.append(f"  held by {row['held_by']}")
        lines += [f"  {v['verdict']:>10}  {v['says']}: {number(v['value'])}, wanted {v['limit']}: {v['because']}"
                  + ("" if len(v["values"]) < 2 else "".join(f"\n{'':14}{run} {number(x)}" for run, x in v["values"].items()))
                  for v in row["figures"].values()]
        lines += [f"    {run}: {end['outcome']}" + (f", {end['message']}" if end.get("message") else "")
                  for run, end in row["runs"].items() if end["outcome"] != "finished"]
        if row["limit"]:
            lines.append(f"  limit: {row['limit']['where']}. Cause: {row['limit']['cause']}")
        lines.append("")
    lines.append(result["verdict"])
    return "\n".join(lines) + "\n"


README_BEGIN, README_END = "<!-- rows of ./sprung study hard --accept -->", "<!-- end of its rows -->"


def readme_rows(result: dict) -> str:
    """README's table: case, figures, limits, verdict, and the commit that was measured."""
    commits = sorted({run["commit"][:7] for row in result["rows"].values() for run in row["runs"].values() if "commit" in run})
    lines = [f"Measured at commit {', '.join(commits)}: {result['verdict']}.", "", "| case | figures | limits | verdict |",
             "|---|---|---|---|"]
    for row in result["rows"].values():
        figures = list(row["figures"].values())
        found = "; ".join(f"{f['says']}: {number(f['value'])}" for f in figures) or row["held_by"] or row["shows"]
        bounds = "; ".join(f["limit"] for f in figures)
        verdict = row["verdict"] + (f": {row['limit']['where']}" if row["limit"] else "")
        lines.append("| " + " | ".join(cell.replace("|", "/") for cell in (row["title"], found, bounds, verdict)) + " |")
    return "\n".join(lines)


def with_rows(readme: str, rows: str) -> str:
    """README with these rows between its marks; as it is where it has none."""
    before, begin, rest = readme.partition(README_BEGIN)
    _, end, after = rest.partition(README_END)
    return f"{before}{begin}\n{rows}\n{end}{after}" if begin and end else readme


def keep(result: dict, reason: str) -> None:
    rows = {name: {**row, "figures": {key: {k: v for k, v in figure.items() if k != "curves"}
                                      for key, figure in row["figures"].items()}}
            for name, row in result["rows"].items()}
    (ROWS / "records").mkdir(exist_ok=True)
    write_whole(ROWS / "records" / "hard.json", json.dumps({"accepted_because": reason, **result, "rows": rows}, indent=1) + "\n")
    write_whole(ROWS / "records" / "hard.txt", table(result))
    readme = ROOT / "README.md"
    write_whole(readme, with_rows(readme.read_text(), readme_rows(result)))


def main() -> int:
    parser = argparse.ArgumentParser(prog="./sprung study hard", add_help=False)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "study_hard")
    parser.add_argument("--row", action="append")
    parser.add_argument("--time-limit", type=float, default=1800.0)
    parser.add_argument("--accept", metavar="REASON")
    options = parser.parse_args()
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    names = sorted(file.parent.name for file in ROWS.glob("*/hard.toml"))
    try:
        for name in options.row or ():
            if name not in names:
                raise WrongUse(f"there is no row '{name}'; there are: {', '.join(names)}")
        if options.row and options.accept:
            raise WrongUse("--accept keeps all rows, nothing less")
        rows = [read_row(ROWS / name) for name in names if not options.row or name in options.row]
    except WrongUse as fault:
        say(str(fault))
        return WRONG_USE
    study, result, began = Study(options), {"rows": {}}, time.monotonic()
    for position, row in enumerate(rows):
        say_point("row", position, len(rows), row["name"], began)
        result["rows"][row["name"]] = study.row(row)
        verdicts = [one["verdict"] for one in result["rows"].values()]
        result["verdict"] = ", ".join(f"{verdicts.count(word)} {text}" for word, text in (
            ("passes", "pass"), (LIMIT, "show the method's limit"), (FAIL, "fail"), (NOT_JUDGED, "not judged")))
        write_whole(options.out / "hard.json", json.dumps(result, indent=1, default=str) + "\n")
        write_whole(options.out / "hard.txt", table(result))
    if options.accept:
        keep(result, options.accept)
    return 0 if all(one["verdict"] in ("passes", LIMIT) for one in result["rows"].values()) else 1


if __name__ == "__main__":
    sys.exit(main())
