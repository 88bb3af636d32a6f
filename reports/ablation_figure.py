#!/usr/bin/env python3
"""ablation_figure.py TABLE PICTURE: what each effect and choice is worth, from the table of ./sprung study ablation.

Left, what the result loses without it, by the quantity that loses most; grey, what another start of the same run
changes, below which nothing is told apart. Right, what the run costs without it over what it costs with it.
"""

import csv
import sys
from pathlib import Path

import style  # chooses matplotlib's backend

import matplotlib.pyplot as plt  # noqa: E402

START = "another start"


def read(file: Path) -> tuple[list[dict], str]:
    lines = file.read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#"))), lines[0].lstrip("# ")


def short(text: str, most: int = 58) -> str:
    return text if len(text) <= most else text[: most - 3] + "..."


def draw(rows: list[dict], title: str, file: Path) -> None:
    noise = next((float(row["loss"]) for row in rows if row["switched_off"] == START and row["loss"]), None)
    rows = [row for row in rows if row["switched_off"] not in (START, "nothing")]
    rows = sorted(rows, key=lambda row: float(row["loss"] or "inf"))
    figure, (left, right) = plt.subplots(1, 2, figsize=(1.2 * style.WIDTH, 1.3 + 0.27 * len(rows)), layout="constrained",
                                         sharey=True, width_ratios=[2, 1])
    least = 0.3 * min([float(row["loss"]) for row in rows if row["loss"] and float(row["loss"]) > 0.0] + [noise or 1.0])
    for place, row in enumerate(rows):
        if not row["loss"]:
            left.text(least * 1.1, place, short(row["outcome"]), va="center", fontsize=6.5, color="#777777")
            continue
        loss = float(row["loss"])
        left.barh(place, max(loss, least), color="#c1272d", height=0.6)
        label = f" {loss:.2g}  {row['largest_in']}" if loss else " 0, the same bits"
        if row.get("error"):
            label += f"  (error {float(row['error']):.1%})"
        left.text(max(loss, least), place, label, va="center", fontsize=6.5)
        right.barh(place, float(row["time_ratio"]), color="#0072b2", height=0.6)
        right.text(float(row["time_ratio"]), place, f" {float(row['time_ratio']):.2f}", va="center", fontsize=6.5)
    if noise:
        left.axvspan(least, noise, color="#d9d9d9", zorder=0)
    right.axvline(1.0, color="black", linewidth=0.8)
    most = max([float(row["loss"]) for row in rows if row["loss"]] + [1.0])
    left.set(xscale="log", xlim=(least, most * 200), xlabel="relative L2 difference from the whole run; grey: another start",
             yticks=range(len(rows)), yticklabels=[row["switched_off"] for row in rows], title="lost without it")
    right.set(xlabel="over the whole run's", title="processor time without it")
    right.margins(x=0.2)
    figure.suptitle(title.split(";")[0].split(": loss")[0], fontsize=8.5, x=0.01, ha="left")
    style.save(figure, file)


if __name__ == "__main__":
    if len(sys.argv) != 3 or not Path(sys.argv[1]).exists():
        sys.exit("ablation_figure.py takes the table of ./sprung study ablation and the picture to write")
    draw(*read(Path(sys.argv[1])), Path(sys.argv[2]))
