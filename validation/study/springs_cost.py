#!/usr/bin/env python3
"""springs_cost.py --program PROGRAM --out DIR [--repeats N] [--end TIME] [--accept REASON]: what the springs cost the beam's channel.

Three scenes that differ in the beam alone: elastic (scene.toml), rigid (rigid_beam.toml, a curved wall of the same
outline) and none (no_beam.toml). Each is run N times, one after the other in turn, on one thread, to TIME. The springs
are to set no step: the elastic scene may take at most 1.1 times as long as the rigid one. Leaves DIR/springs.csv and
DIR/springs.json, what made it; --accept keeps both in validation/beam_in_channel/records.

Exit codes: 0 within 1.1, 1 not, 2 wrong use, 6 a run refused or failed.
"""

import argparse
import json
import statistics
import sys
from pathlib import Path

import quantities

from verify import Runner, facts, say, write_whole  # noqa: I001  (quantities.py made the driver known)
from record import Record

WRONG_USE, NO_RUN = 2, 6
LIMIT = 1.1
CASE = quantities.ROOT / "validation" / "beam_in_channel"
SCENES = {"elastic": "scene.toml", "rigid": "rigid_beam.toml", "none": "no_beam.toml"}


def overrides(beam: str, end: str) -> list:
    """Probes look at the end of the run: their times in the scene lie beyond it."""
    probes = ["profile", "outline"] if beam == "elastic" else ["profile"]
    return [f'time.end="{end}"', *(f'probes.{probe}.times=["{end}"]' for probe in probes)]


def measured(options: argparse.Namespace) -> dict | None:
    """Facts of every run by beam; None if one failed. In turn: a machine that slows down slows all three."""
    runner, found = Runner(options.program.resolve(), 1, None), {beam: [] for beam in SCENES}
    for repeat in range(1, options.repeats + 1):
        for beam, scene in SCENES.items():
            folder = options.out.resolve() / "runs" / f"{beam}_{repeat}"
            fault = runner.run(f"{beam} beam, run {repeat} of {options.repeats}", CASE / scene, overrides(beam, options.end), folder)
            if fault:
                say(f"{beam} beam: {fault}")
                return None
            found[beam].append(facts(Record(folder, beam), folder))
    return found


def table(found: dict, end: str) -> tuple[str, float]:
    medians = {beam: statistics.median(run["processor_seconds"] for run in runs) for beam, runs in found.items()}
    lines = [f"# Processor time of the beam's channel to t = {end}, one thread: the beam elastic, rigid, left out; made by "
             "./sprung study springs, what made it stands in the JSON file beside it.",
             "beam,repeats,processor_seconds,processor_seconds_least,processor_seconds_most,over_rigid,steps,time_step_s,particles"]
    for beam, runs in found.items():
        seconds = [run["processor_seconds"] for run in runs]
        lines.append(f"{beam},{len(runs)},{medians[beam]:.4g},{min(seconds):.4g},{max(seconds):.4g},"
                     f"{medians[beam] / medians['rigid']:.3f},{runs[0]['steps']},{runs[0]['time_step']:.6g},{runs[0]['particles']}")
    return "\n".join(lines) + "\n", medians["elastic"] / medians["rigid"]


def main() -> int:
    parser = argparse.ArgumentParser(prog="./sprung study springs", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--end", default="0.3 s")
    parser.add_argument("--accept", metavar="REASON")
    options = parser.parse_args()
    if options.repeats < 1:
        say(f"--repeats takes a number from 1 on, not {options.repeats}")
        return WRONG_USE
    found = measured(options)
    if found is None:
        return NO_RUN
    runs = [run for each in found.values() for run in each]
    about = {"format": "sprung springs 1", "accepted_because": options.accept or "", "end": options.end, "limit": LIMIT,
             **{key: sorted({str(run[key]) for run in runs}) for key in ("commit", "clean", "processor", "threads")},
             "load_at_start": [run["load_at_start"] for run in runs]}
    text, ratio = table(found, options.end)
    folders = [options.out]
    if options.accept and about["clean"] == ["yes"]:
        folders.append(CASE / "records")
    for folder in folders:
        write_whole(folder / "springs.csv", text)
        write_whole(folder / "springs.json", json.dumps(about, indent=1) + "\n")
    print(text, end="")
    print(f"elastic over rigid: {ratio:.2f}, {'within' if ratio <= LIMIT else 'NOT within'} {LIMIT:g}")
    if options.accept and len(folders) == 1:
        say("--accept keeps what a clean commit made; these runs were made with changes that are not committed")
        return WRONG_USE
    return 0 if ratio <= LIMIT else 1


if __name__ == "__main__":
    sys.exit(main())
