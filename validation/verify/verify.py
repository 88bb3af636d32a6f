#!/usr/bin/env python3
"""verify.py CASE-FOLDER --program sprung-sph --out DIR [...]: the particle solver against an exact solution.

Runs every series of CASE-FOLDER/verification.toml over its spacings, measures the errors and their order, judges
them by the limits there, and leaves DIR/verification.json and the table DIR/verdicts.txt. What the same program has
answered already for the same scene is not run again; what was stopped is taken up where it stands.

verification.toml:
  title, says                what the case is and what it shows
  [series.NAME]              title; spacings, coarse to fine, at least three; scene (else scene.toml); overrides,
                             as on the command line; at."SPACING", further overrides of that spacing alone
  [series.NAME.check.CHECK]  says, kind and what that kind needs (measures.py)
    limits                   [{ at = SPACING, most = ERROR, because = REASON }, ...]
    order                    { from, to, because }: range of the slope of log error over log spacing, all spacings
  [series.NAME.processor_time]  at, most (s), because

Exit codes: 0 within every limit, 1 outside one or not shown to be within, 2 wrong use, 6 a scene was refused.
"""

import argparse
import hashlib
import json
import math
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import measures
from scene import SceneMismatch

from record import Record, quantity  # noqa: I001  (scene.py made the reader known)

ROOT = Path(__file__).resolve().parents[2]
WRONG_USE, NO_RUN = 2, 6
PASS, FAIL, NOT_JUDGED = "pass", "FAIL", "not judged"


def say(text: str) -> None:
    print(f"sprung: {text}", file=sys.stderr, flush=True)


class WrongUse(Exception):
    pass


# ------------------------------------------------------------------------------------------- what is asked


def read_case(folder: Path) -> dict:
    """verification.toml, checked for what the driver relies on."""
    file = folder / "verification.toml"
    case = tomllib.loads(file.read_text())
    for name, series in case.get("series", {}).items():
        where = f"{file}: [series.{name}]"
        spacings = series.get("spacings", [])
        sizes = [quantity(text) for text in spacings]
        if len(sizes) < 3 or sorted(sizes, reverse=True) != sizes or len(set(sizes)) != len(sizes):
            raise WrongUse(f"{where} needs at least three spacings, from coarse to fine, not {spacings}")
        if not series.get("check"):
            raise WrongUse(f"{where} has no check")
        for check_name, check in series["check"].items():
            check_check(f"{where} check.{check_name}", check, spacings)
        for key in ("at", "most", "because"):
            if "processor_time" in series and key not in series["processor_time"]:
                raise WrongUse(f"{where} processor_time lacks '{key}'")
    if not case.get("series"):
        raise WrongUse(f"{file} has no [series.<name>]")
    return case


def check_check(where: str, check: dict, spacings: list) -> None:
    if check.get("kind") not in measures.KINDS:
        raise WrongUse(f"{where}: kind must be one of {', '.join(measures.KINDS)}, not {check.get('kind')!r}")
    if not check.get("says"):
        raise WrongUse(f"{where} lacks 'says', in words what is measured")
    for limit in check.get("limits", []):
        if set(limit) != {"at", "most", "because"} or limit["at"] not in spacings:
            raise WrongUse(f"{where}: a limit has at (one of {spacings}), most and because, not {limit}")
    if "order" in check and set(check["order"]) != {"from", "to", "because"}:
        raise WrongUse(f"{where}: order has from, to and because")
    if not check.get("limits") and "order" not in check:
        raise WrongUse(f"{where} has neither limits nor an order: it could not fail")


def arguments_of(series: dict, spacing: str, further: list) -> list:
    return [*series.get("overrides", []), *series.get("at", {}).get(spacing, []), f'sph.spacing="{spacing}"', *further]


# ---------------------------------------------------------------------------------------------------- runs


def digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def request(program: Path, scene: Path, arguments: list) -> str:
    """What a record depends on: program, scene, the files that the scene names, arguments."""
    named = sorted(set(re.findall(r'file\s*=\s*"([^"]+)"', scene.read_text() + "\n".join(arguments))))
    files = [f"file {name} {digest(scene.parent / name)}" for name in named if (scene.parent / name).exists()]
    return "\n".join([f"program {digest(program)}", f"scene {digest(scene)}", *files,
                      *(f"argument {one}" for one in arguments)]) + "\n"


def manifest_reads(file: Path) -> bool:
    """Whether there is a manifest that is not damaged: a disk that was full leaves an empty one."""
    try:
        return isinstance(json.loads(file.read_text()), dict)
    except (OSError, ValueError):
        return False


class Runner:
    """Runs a solver; `verb` is what its command line begins with, nothing for the finite element reference."""

    def __init__(self, program: Path, threads: int, time_limit: float | None, verb: list | None = None):
        self.program, self.threads, self.time_limit = program, threads, time_limit
        self.verb = ["run"] if verb is None else verb
        self.child = None
        for number in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: sys.exit(130))

    def run(self, label: str, scene: Path, arguments: list, folder: Path) -> str:
        """Leaves a record in `folder`; returns "" or why there is none that is whole."""
        folder.parent.mkdir(parents=True, exist_ok=True)
        asked, answered = folder.with_name(folder.name + ".asked"), folder.with_name(folder.name + ".answered")
        wanted = request(self.program, scene, arguments)
        readable = manifest_reads(folder / "manifest.json")
        if readable and answered.exists() and answered.read_text() == wanted:
            say(f"{label}: already there")
            return ""
        how = ["--overwrite"]
        if readable and asked.exists() and asked.read_text() == wanted:
            how.append("--resume")  # from the last checkpoint; from the start where there is none
        answered.unlink(missing_ok=True)
        asked.write_text(wanted)
        folder.with_name(folder.name + ".load").write_text(f"{os.getloadavg()[0]:.2f}\n")
        say(f"{label}: running")
        code = self._call([self.program, *self.verb, scene, *arguments, "--out", folder, *how, "--threads", self.threads])
        if code in (0, 3):
            answered.write_text(wanted)
            return ""
        if code is None:
            return f"reached its time limit of {self.time_limit:g} s; call again to go on"
        return f"the solver refused or failed, exit code {code}"

    def _call(self, command: list) -> int | None:
        self.child = subprocess.Popen([str(part) for part in command], stdout=sys.stderr)
        try:
            return self.child.wait(self.time_limit)
        except subprocess.TimeoutExpired:
            return None
        finally:
            if self.child.poll() is None:
                self.child.terminate()  # it leaves a checkpoint
                try:
                    self.child.wait(30)
                except subprocess.TimeoutExpired:
                    self.child.kill()


def facts(record: Record, folder: Path) -> dict:
    """What a reader of the result wants to know of one run."""
    manifest = record.manifest
    load = folder.with_name(folder.name + ".load")
    return {"outcome": manifest["outcome"], "particles": int(manifest["numbers"].get("particles", 0)),
            "steps": int(manifest["numbers"].get("steps", 0)), "time_step": manifest["numbers"]["time_step"],
            "processor_seconds": manifest["processor_seconds"], "wall_seconds": manifest["wall_seconds"],
            "peak_memory_bytes": manifest["peak_memory_bytes"], "threads": manifest["threads"],
            "commit": manifest["commit"], "clean": manifest["clean"], "processor": manifest["processor"],
            "load_at_start": float(load.read_text()) if load.exists() else None}


# ------------------------------------------------------------------------------------------------ verdicts


def slope(spacings: list, errors: list) -> float | None:
    """Least squares slope of log error over log spacing; None if there are too few, or an error is zero."""
    if len(errors) < 2 or min(errors) <= 0.0:
        return None
    x, y = [math.log(s) for s in spacings], [math.log(e) for e in errors]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def judge(check: dict, spacings: list, errors: dict) -> tuple[float | None, list]:
    """(order over the spacings that have an error, verdicts). `spacings`: those that this level runs."""
    verdicts = []
    for limit in check.get("limits", []):
        if limit["at"] not in spacings:
            continue
        error = errors.get(limit["at"])
        verdict = NOT_JUDGED if error is None else PASS if error <= limit["most"] else FAIL
        verdicts.append({"of": f"error at {limit['at']}", "value": error, "limit": f"<= {limit['most']:g}",
                         "verdict": verdict, "because": limit["because"]})
    have = [s for s in spacings if s in errors]
    order = slope([quantity(s) for s in have], [errors[s] for s in have])
    if "order" in check and len(spacings) >= 3:
        wanted = check["order"]
        whole = order is not None and len(have) == len(spacings)
        verdict = NOT_JUDGED if not whole else PASS if wanted["from"] <= order <= wanted["to"] else FAIL
        verdicts.append({"of": "order", "value": order, "limit": f"{wanted['from']:g} to {wanted['to']:g}",
                         "verdict": verdict, "because": wanted["because"]})
    return order, verdicts


def measure_series(series: dict, records: dict, spacings: list, folder: Path) -> dict:
    """The checks of one series: errors, curves of the finest record, order, verdicts."""
    result = {}
    for name, check in series["check"].items():
        errors, figures, curves, axes, missing = {}, {}, [], ("", ""), {}
        for spacing, record in records.items():
            try:
                finding = measures.measure(record, check, folder)
            except measures.Missing as cause:
                missing[spacing] = str(cause)
                continue
            errors[spacing], figures[spacing] = finding.error, finding.figures
            curves, axes = [vars(curve) for curve in finding.curves], finding.axes
        order, verdicts = judge(check, spacings, errors)
        result[name] = {"says": check["says"], "kind": check["kind"], "errors": errors, "figures": figures,
                        "missing": missing, "order": order, "verdicts": verdicts, "curves": curves, "axes": axes,
                        "expected_order": check.get("order")}
    return result


def judge_time(series: dict, runs: dict, spacings: list) -> list:
    limit = series.get("processor_time")
    if not limit or limit["at"] not in spacings:
        return []
    run = runs.get(limit["at"], {})
    spent = run.get("processor_seconds") if run.get("outcome") == "finished" else None
    verdict = NOT_JUDGED if spent is None else PASS if spent <= limit["most"] else FAIL
    return [{"of": f"processor time at {limit['at']}", "value": spent, "limit": f"<= {limit['most']:g} s",
             "verdict": verdict, "because": limit["because"]}]


# --------------------------------------------------------------------------------------------------- table


def number(value) -> str:
    return "-" if value is None else f"{value:.3g}"


def table(result: dict) -> str:
    lines = [result["title"], ""]
    for series in result["series"].values():
        lines.append(series["title"])
        for name, check in series["checks"].items():
            lines.append(f"  {name}: {check['says']}")
            lines.append(f"    {'spacing':>10} {'particles':>9} {'error':>10} {'order':>6} {'processor s':>11}")
            before = None
            for spacing, run in series["runs"].items():
                error = check["errors"].get(spacing)
                pair = None
                if before and error and check["errors"].get(before):
                    pair = slope([quantity(before), quantity(spacing)], [check["errors"][before], error])
                lines.append(f"    {spacing:>10} {run.get('particles', 0):>9} {number(error):>10} "
                             f"{number(pair):>6} {number(run.get('processor_seconds')):>11}"
                             + (f"  {check['missing'][spacing]}" if spacing in check["missing"] else "")
                             + ("" if run.get("outcome") == "finished" else f"  {run['outcome']}"))
                before = spacing
            lines += [f"    {v['verdict']:>10}  {v['of']} {number(v['value'])}, wanted {v['limit']}: {v['because']}"
                      for v in check["verdicts"]]
        lines += [f"  {v['verdict']:>10}  {v['of']} {number(v['value'])}, wanted {v['limit']}: {v['because']}"
                  for v in series["verdicts"]]
        lines.append("")
    lines.append(result["verdict"])
    return "\n".join(lines) + "\n"


# ---------------------------------------------------------------------------------------------------- main


def all_verdicts(result: dict) -> list:
    return [v for series in result["series"].values()
            for v in [*series["verdicts"], *(v for check in series["checks"].values() for v in check["verdicts"])]]


def verify(folder: Path, options: argparse.Namespace) -> dict:
    case = read_case(folder)
    runner = Runner(options.program, options.threads, options.time_limit)
    chosen = options.series or list(case["series"])
    for name in chosen:
        if name not in case["series"]:
            raise WrongUse(f"the case has no series '{name}'; there are: {', '.join(case['series'])}")
    result = {"case": folder.name, "title": case["title"], "says": case.get("says", ""),
              "level": "quick" if options.quick else "full", "with": options.overrides, "series": {}}
    for name in chosen:
        series = case["series"][name]
        spacings = series["spacings"][:2] if options.quick else series["spacings"]
        records, runs = {}, {}
        for spacing in spacings:
            out = options.out / name / spacing.replace(" ", "")
            scene = folder / series.get("scene", "scene.toml")
            fault = runner.run(f"{folder.name} {name} {spacing}", scene, arguments_of(series, spacing, options.overrides),
                               out)
            if fault:
                say(f"{folder.name} {name} {spacing}: {fault}")
                runs[spacing] = {"outcome": fault}
                continue
            records[spacing] = Record(out, spacing)
            runs[spacing] = {**facts(records[spacing], out), "folder": str(out.relative_to(options.out))}
        result["series"][name] = {"title": series["title"], "spacings": spacings, "runs": runs,
                                  "checks": measure_series(series, records, spacings, folder),
                                  "verdicts": judge_time(series, runs, spacings)}
    verdicts = [v["verdict"] for v in all_verdicts(result)]
    result["passed"] = all(v == PASS for v in verdicts) and bool(verdicts)
    result["verdict"] = (f"within the limits: {verdicts.count(PASS)} of {len(verdicts)}" if result["passed"] else
                         f"not within the limits: {verdicts.count(FAIL)} of {len(verdicts)} fail, "
                         f"{verdicts.count(NOT_JUDGED)} not judged")
    return result


def write_whole(file: Path, text: str) -> None:
    beside = file.with_name(file.name + ".new")
    beside.write_text(text)
    os.replace(beside, file)


def keep_file(file: Path, folder: Path) -> None:
    """A copy of a study's table, as its accepted one."""
    folder.mkdir(exist_ok=True)
    write_whole(folder / file.name, file.read_text())


def say_point(kind: str, position: int, count: int, name: str, began: float) -> None:
    """Which point of how many begins, and the time left if the rest take as long as those done; `began`: monotonic."""
    spent = time.monotonic() - began
    left = f", about {spent / position * (count - position):.0f} s left" if position else ""
    say(f"{kind} {position + 1} of {count}: {name}{left}")


def study_parser(name: str) -> argparse.ArgumentParser:
    """What a study of many small runs is told by the front door."""
    parser = argparse.ArgumentParser(prog=f"./sprung study {name}", add_help=False)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=ROOT / "results" / f"study_{name}")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--accept", action="store_true")
    parser.add_argument("--time-limit", type=float, default=300.0)
    return parser


def keep(result: dict, folder: Path, reason: str) -> None:
    """The result without its curves, as the case's accepted record."""
    series = {name: {**one, "checks": {key: {k: v for k, v in check.items() if k != "curves"}
                                       for key, check in one["checks"].items()}}
              for name, one in result["series"].items()}
    (folder / "records").mkdir(exist_ok=True)
    write_whole(folder / "records" / "verification.json",
                json.dumps({"accepted_because": reason, **result, "series": series}, indent=1) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser(prog="./sprung validate", add_help=False)
    parser.add_argument("case", type=Path)
    parser.add_argument("overrides", nargs="*")
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--series", action="append")
    parser.add_argument("--time-limit", type=float)
    parser.add_argument("--accept", metavar="REASON")
    options = parser.parse_intermixed_args()  # overrides may stand after options
    level = "quick" if options.quick else "full"
    options.out = (options.out or ROOT / "results" / options.case.name / level).resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        result = verify(options.case.resolve(), options)
        if options.accept and (options.overrides or options.quick or options.series):
            raise WrongUse("--accept keeps a full run of every series without overrides, nothing less")
    except (WrongUse, SceneMismatch) as fault:
        say(str(fault))
        return WRONG_USE
    write_whole(options.out / "verification.json", json.dumps(result, indent=1) + "\n")
    write_whole(options.out / "verdicts.txt", table(result))
    if options.accept:
        keep(result, options.case.resolve(), options.accept)
    runs = [run for series in result["series"].values() for run in series["runs"].values()]
    if all("refused" in run["outcome"] for run in runs):
        return NO_RUN
    return 0 if result["passed"] else 1


if __name__ == "__main__":
    sys.exit(main())
