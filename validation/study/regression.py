#!/usr/bin/env python3
"""regression.py measure|accept|check|compare CASE-FOLDER --level LEVEL [...]: a run against an earlier, accepted one.

measure   runs what the limits are made of into --out: the case's judged run as it is, from several disordered starts,
          and with Young's modulus or viscosity 1 % larger; leaves limits.json
accept    keeps a record (the judged run's in --runs) as the case's baseline, validation/CASE/baseline/LEVEL.json, with the limits and
          --because, why
compare   holds a record against a baseline (--against): every quantity, its relative L2, lag and amplitude ratio, and
          the cost. Exit code 1 if a quantity differs by more than its limit

A quantity's limit lies between the noise, the largest difference between two starts, and the signal, the difference
that 1 % of a material constant makes: at their geometric mean, so that it is as far above what means nothing as below
what does, and at least half again above the noise, since the largest of six differences is no upper bound (a seventh
passes it once in seven). Where the signal is no larger than that, a change of 1 % cannot be seen in that quantity, and
the table says so.
"""

import argparse
import itertools
import json
import math
import sys
import tomllib
from pathlib import Path

import quantities

from differences import differences, kept  # noqa: I001  (quantities.py made the reader known)
from verify import Runner, facts, say, write_whole
from record import Record, quantity

WRONG_USE, NO_RUN = 2, 6
DISORDER, SEEDS, CHANGE = 0.02, (1, 2, 3), 0.01
MARGIN = 1.5  # above the largest difference between two starts
LEAST_LIMIT = 1e-7  # a baseline keeps nine digits of every number


class WrongUse(Exception):
    pass


def record_in(runs: Path, case: Path, level: str) -> Record:
    """The judged run's record among those that a validation left."""
    folder = runs / judged_run(case, level)[0]
    if not (folder / "manifest.json").exists():
        raise WrongUse(f"{folder} holds no record; the run was left out")
    return Record(folder, "now")


def flattened(table: dict, prefix: str = "") -> list:
    """A nested table as overrides, table.key=value."""
    found = []
    for key, value in table.items():
        if isinstance(value, dict):
            found += flattened(value, f"{prefix}{key}.")
        else:
            found.append(f"{prefix}{key}={json.dumps(value, ensure_ascii=False)}")
    return found


def judged_run(case: Path, level: str) -> tuple[str, list]:
    """Name and overrides of the level's first run that has limits."""
    table = tomllib.loads((case / "acceptance.toml").read_text())
    for name, run in table[level]["run"].items():
        if "limits" in run:
            return name, flattened(run.get("scene", {}))
    raise WrongUse(f"{case / 'acceptance.toml'}: no run of [{level}] has limits")


def changes_of(scene: dict) -> dict:
    """Overrides that make each material constant 1 % larger, by its name."""
    found = {}
    if "viscosity" in scene:
        value = quantity(scene["viscosity"]["dynamic"]) * (1.0 + CHANGE)
        found["viscosity"] = [f'viscosity.dynamic="{value:.12g} Pa s"']
    for name, solid in scene.get("solid", {}).items():
        value = quantity(solid["youngs_modulus"]) * (1.0 + CHANGE)
        found[f"modulus of {name}"] = [f'solid.{name}.youngs_modulus="{value:.12g} Pa"']
    return found


def limits_of(base: dict, starts: list, changed: dict) -> dict:
    """Noise, signals and limit of every quantity; `starts` and the values of `changed` are answers of kept()."""
    limits = {one.quantity: {"noise": 0.0, "noise_lag": 0.0, "noise_amplitude": 0.0, "signal": {}}
              for one in differences(base, base)}
    for first, second in itertools.combinations([base, *starts], 2):
        for one in differences(first, second):
            row = limits[one.quantity]
            row["noise"] = max(row["noise"], one.l2)
            if one.lag is not None:
                row["noise_lag"] = max(row["noise_lag"], abs(one.lag))
                row["noise_amplitude"] = max(row["noise_amplitude"], abs((one.amplitude or 1.0) - 1.0))
    for name, run in changed.items():
        for one in differences(base, run):
            limits[one.quantity]["signal"][name] = one.l2
    for row in limits.values():
        signal = max(row["signal"].values(), default=0.0)
        row["blind"] = signal <= MARGIN * row["noise"]
        row["limit"] = max(LEAST_LIMIT, MARGIN * row["noise"], math.sqrt(row["noise"] * signal))
    return limits


def measure(case: Path, options: argparse.Namespace) -> int:
    name, overrides = judged_run(case, options.level)
    runner = Runner(options.program.resolve(), 1, None)
    out = options.out.resolve()
    scene = case / "scene.toml"

    def answer(label: str, further: list) -> Record:
        folder = out / label.replace(" ", "_").replace("%", "")
        fault = runner.run(f"{case.name} {options.level} {name}, {label}", scene, [*overrides, *further], folder)
        if fault:
            raise WrongUse(f"{label}: {fault}")
        record = Record(folder, label)
        if not record.finished:
            raise WrongUse(f"{label}: {record.manifest['outcome']}")
        return record

    base = answer("as it is", [])
    changes = changes_of(tomllib.loads(base.manifest["scene_toml"]))
    starts = [answer(f"start {seed}", [f"sph.disorder={DISORDER}", f"sph.seed={seed}"]) for seed in SEEDS]
    changed = {what: answer(f"{what} 1% larger", further) for what, further in changes.items()}
    limits = limits_of(kept(base), [kept(one) for one in starts], {what: kept(one) for what, one in changed.items()})
    about = {"format": "sprung regression limits 1", "case": case.name, "level": options.level, "run": name,
             "says": f"noise: {len(starts) + 1} starts, the lattice and {len(starts)} moved by up to {DISORDER} spacings; "
                     f"signal: a material constant {CHANGE:.0%} larger",
             "commit": base.manifest["commit"], "clean": base.manifest["clean"], "limits": limits}
    write_whole(out / "limits.json", json.dumps(about, indent=1) + "\n")
    blind = [key for key, row in limits.items() if row["blind"]]
    print(f"{len(limits)} quantities; a change of 1 % is above the noise in {len(limits) - len(blind)} of them")
    print(f"limits: {out / 'limits.json'}")
    return 0


def rounded(numbers):
    """Nine digits are more than any limit asks for, and a third of the file."""
    if isinstance(numbers, dict):
        return {key: rounded(value) for key, value in numbers.items()}
    return [float(f"{value:.9g}") for value in numbers]


def accept(case: Path, options: argparse.Namespace) -> int:
    if not options.because or not options.because.strip():
        raise WrongUse("accepting a baseline says why: --accept REASON")
    limits_file = options.limits
    if not limits_file.exists():
        raise WrongUse(f"there are no limits in {limits_file}; ./sprung study noise {case.name} measures them")
    record = record_in(options.runs, case, options.level)
    if not record.finished:
        raise WrongUse(f"the run is no baseline: {record.manifest['outcome']}")
    about = json.loads(limits_file.read_text())
    numbers = kept(record)
    lacks = about["limits"].keys() - {one.quantity for one in differences(numbers, numbers)}
    if lacks:
        raise WrongUse(f"the record is no baseline, it lacks {', '.join(sorted(lacks)[:3])}{' and more' * (len(lacks) > 3)}")
    made = facts(record, record.folder)
    if made["clean"] != "yes":
        raise WrongUse("a baseline comes from a clean commit; this record was made with changes not committed")
    content = {"format": "sprung baseline 1", "accepted_because": options.because, "case": case.name,
               "level": options.level, "run": about["run"], "made_by": made,
               "scene_toml": record.manifest["scene_toml"],
               "limits_measured_at": about["commit"], "limits_say": about["says"],
               "limits": {name: {key: value if not isinstance(value, float) else float(f"{value:.4g}")
                                 for key, value in row.items()} for name, row in about["limits"].items()},
               **rounded_parts(numbers)}
    file = case / "baseline" / f"{options.level}.json"
    file.parent.mkdir(exist_ok=True)
    write_whole(file, json.dumps(content, separators=(",", ":")).replace('],"', '],\n"') + "\n")
    print(f"baseline: {file} ({made['commit'][:7]})")
    return 0


def rounded_parts(numbers: dict) -> dict:
    return {"series": rounded(numbers["series"]), "tables": rounded(numbers["tables"])}


def same_scene(baseline: dict, record: Record) -> list:
    """Physics in which the two scenes differ, by table; numerics may differ, they are what is tested."""
    ours, theirs = tomllib.loads(record.manifest["scene_toml"]), tomllib.loads(baseline["scene_toml"])
    free = {"title", "source", "numerics", "reference_fem", "record"}
    return sorted(key for key in (ours.keys() | theirs.keys()) - free if ours.get(key) != theirs.get(key))


def read_baseline(options: argparse.Namespace) -> dict:
    try:
        baseline = json.loads(options.against.read_text())
    except (OSError, ValueError) as fault:
        raise WrongUse(f"--against {options.against}: no baseline can be read there ({fault})") from None
    if not isinstance(baseline, dict) or baseline.get("format") != "sprung baseline 1":
        raise WrongUse(f"--against {options.against} is no baseline; validation/CASE/baseline holds those accepted")
    if baseline["level"] != options.level:
        raise WrongUse(f"the baseline is of level {baseline['level']}, the run of level {options.level}")
    return baseline


def compare(case: Path, options: argparse.Namespace) -> int:
    baseline = read_baseline(options)
    record = record_in(options.runs, case, options.level)
    other = same_scene(baseline, record)
    if other:
        raise WrongUse(f"the baseline is of another scene: {', '.join(other)} differ; accept a new one, or run that scene")
    if not record.finished:
        print(f"not judged: the run did not finish: {record.manifest['outcome']}")
        return 1
    rows, worst = verdicts(baseline, kept(record))
    text = table(baseline, record, rows, worst)
    write_whole(options.out / "against.txt", text)
    print(text, end="")
    return 1 if any(row["verdict"] == "CHANGED" for row in rows) else 0


def verdicts(baseline: dict, numbers: dict) -> tuple[list, list]:
    """A row a quantity, and those rows that came nearest to their limit or beyond."""
    rows = []
    for one in differences(baseline, numbers):
        limit = baseline["limits"].get(one.quantity)
        if limit is None:
            continue
        share = one.l2 / limit["limit"] if limit["limit"] > 0.0 else (0.0 if one.l2 == 0.0 else math.inf)
        rows.append({**vars(one), **limit, "share": share, "verdict": "CHANGED" if share > 1.0 else "same"})
    found = {row["quantity"] for row in rows}
    rows += [{"quantity": name, "l2": math.inf, "lag": None, "amplitude": None, **limit, "share": math.inf,
              "verdict": "CHANGED"} for name, limit in baseline["limits"].items() if name not in found]
    return rows, sorted(rows, key=lambda row: -row["share"])[:3]


def table(baseline: dict, record: Record, rows: list, worst: list) -> str:
    made = baseline["made_by"]
    lines = [f"against {made['commit'][:7]}, accepted because: {baseline['accepted_because']}", "",
             f"  {'quantity':34} {'rel. L2':>9} {'limit':>9} {'noise':>9} {'1 %':>9} {'lag [ms]':>9} {'ratio':>7}"]
    for row in rows:
        signal = max(row["signal"].values(), default=0.0)
        lag = "" if row["lag"] is None else f"{1e3 * row['lag']:.3g}"
        ratio = "" if row["amplitude"] is None else f"{row['amplitude']:.4f}"
        lines.append(f"  {row['quantity']:34} {row['l2']:9.2e} {row['limit']:9.2e} {row['noise']:9.2e} {signal:9.2e} "
                     f"{lag:>9} {ratio:>7}  {row['verdict']}{' (blind to 1 %)' if row['blind'] else ''}")
    now = record.manifest
    lines += ["", "  cost, reported: it depends on the machine and what else runs there",
              f"    processor time {now['processor_seconds']:.4g} s, before {made['processor_seconds']:.4g} s, ratio "
              f"{now['processor_seconds'] / made['processor_seconds']:.3f}; steps {int(now['numbers']['steps'])}, before "
              f"{made['steps']}; memory {now['peak_memory_bytes'] / 1e6:.4g} MB, before "
              f"{made['peak_memory_bytes'] / 1e6:.4g} MB", ""]
    changed = sum(row["verdict"] == "CHANGED" for row in rows)
    nearest = ", ".join(f"{row['quantity']} at {row['share']:.2g} of its limit" for row in worst)
    lines.append(f"{'changed' if changed else 'the same'}: {changed} of {len(rows)} quantities beyond their limit; nearest: "
                 f"{nearest}")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["measure", "accept", "check", "compare"])
    parser.add_argument("case", type=Path)
    parser.add_argument("--level", default="full")
    parser.add_argument("--program", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--runs", type=Path)
    parser.add_argument("--limits", type=Path)
    parser.add_argument("--because")
    parser.add_argument("--against", type=Path)
    options = parser.parse_args()
    try:
        if options.what == "check":
            return 0 if read_baseline(options) else WRONG_USE
        return {"measure": measure, "accept": accept, "compare": compare}[options.what](options.case.resolve(), options)
    except (WrongUse, quantities.Missing, FileNotFoundError) as fault:
        say(str(fault))
        return WRONG_USE


if __name__ == "__main__":
    sys.exit(main())
