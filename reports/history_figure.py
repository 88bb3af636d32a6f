#!/usr/bin/env python3
"""history_figure.py CASE-FOLDER PICTURE: a case's figures over the commits that have records.

Reads CASE-FOLDER/records/*/measurements.csv, one folder a commit, in the order in which the runs were made; draws every
measure that has a limit somewhere, the largest over its times, of every run that it was taken of, and the limit.
"""

import csv
import json
import sys
from pathlib import Path

import style  # chooses matplotlib's backend

import matplotlib.pyplot as plt  # noqa: E402


def records_of(case: Path) -> list[tuple[str, str, list[dict]]]:
    """(time, commit, rows) of every record, in the order of their runs."""
    found = []
    for table in sorted(case.glob("records/*/measurements.csv")):
        started = [json.loads(file.read_text())["start_time_utc"] for file in table.parent.glob("manifest_*.json")]
        if started:
            found.append((min(started), table.parent.name, list(csv.DictReader(table.read_text().splitlines()))))
    return sorted(found)


def judged(records: list) -> dict:
    """{measure: (unit, limit)} of those that have a limit in any record."""
    return {row["measure"]: (row["unit"], float(row["limit"]))
            for _, _, rows in records for row in rows if row["limit"] and float(row["limit"]) > 0.0}


def largest(rows: list[dict], measure: str, run: str) -> float | None:
    values = [abs(float(row["value"])) for row in rows
              if row["measure"] == measure and row["run"] == run and row["value"]]
    return max(values) if values else None


def draw(case: Path, records: list, file: Path) -> None:
    measures = judged(records)
    runs = list(dict.fromkeys(row["run"] for _, _, rows in records for row in rows))
    columns = min(3, len(measures))
    lines = -(-len(measures) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(1.2 * style.WIDTH, 2.4 * lines + 0.6), layout="constrained",
                                squeeze=False)
    for panel in axes.flat[len(measures):]:
        panel.axis("off")
    for panel, (measure, (unit, limit)) in zip(axes.flat, measures.items()):
        for number, run in enumerate(runs):
            points = [(place, largest(rows, measure, run)) for place, (_, _, rows) in enumerate(records)]
            points = [(place, value) for place, value in points if value is not None]
            if points:
                panel.plot(*zip(*points), "o-", color=style.colour(run, number), label=run, markersize=4)
        panel.axhline(limit, color="black", linewidth=0.8, linestyle=(0, (4, 2)))
        panel.annotate(" limit", (0, limit), fontsize=7, va="bottom")
        panel.set(title=f"{measure.replace('_', ' ')}{'' if unit == '1' else f' [{unit}]'}", yscale="log",
                  xticks=range(len(records)), xlim=(-0.3, len(records) - 0.7))
        panel.set_xticklabels([f"{commit}\n{started[:10]}" for started, commit, _ in records], fontsize=7)
    drawn = dict(pair for panel in axes.flat for pair in zip(*reversed(panel.get_legend_handles_labels())))
    place = axes.flat[len(measures)] if len(measures) < axes.size else axes.flat[0]
    place.legend(drawn.values(), drawn.keys(), fontsize=8, loc="best" if len(measures) == axes.size else "upper left")
    figure.suptitle(f"{case.name}: largest over the judged times, by commit", fontsize=9, x=0.01, ha="left")
    style.save(figure, file)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("history_figure.py takes the folder of a case and the picture to write")
    kept = records_of(Path(sys.argv[1]))
    if not kept:
        sys.exit(f"history_figure.py: {sys.argv[1]} has no records/COMMIT/measurements.csv")
    draw(Path(sys.argv[1]).resolve(), kept, Path(sys.argv[2]))
