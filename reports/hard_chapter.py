#!/usr/bin/env python3
"""hard_chapter.py [--record FILE] [--pictures DIR] [--out FILE]: the chapter on the hard cases, one file of HTML: the table of
cases, figures, limits and verdicts from a record of `./sprung study hard` (default the kept one), the map of stable steps, and
the pictures that the study left in DIR, where there are any. Never runs a solver.

    reports/hard_chapter.py                                          results/hard_chapter.html, from the kept record
    reports/hard_chapter.py --record results/study_hard/hard.json --pictures results/study_hard
"""

import argparse
import base64
import html
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STYLE = ("body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em}table{border-collapse:collapse}"
         "td,th{border-bottom:1px solid #ddd;padding:.3em .6em;text-align:left;vertical-align:top}img{max-width:100%}")
HEAD = ["case", "figure", "found", "limit", "verdict"]


def number(value: float | None) -> str:
    return "not measured" if value is None else f"{value:.3g}"


def table_rows(result: dict) -> list[list[str]]:
    """A line for every figure of every row; rows without one say where they are held or what their runs did."""
    lines = []
    for row in result["rows"].values():
        figures = [[f["says"], number(f["value"]), f["limit"], f["verdict"]] for f in row["figures"].values()]
        if not figures:
            ends = ", ".join(sorted({run["outcome"] for run in row["runs"].values()}))
            figures = [[row["held_by"] or f"runs that end: {ends}", "", "", ""]]
        for position, figure in enumerate(figures):
            lines.append([f"{row['title']}: {row['verdict']}" if position == 0 else "", *figure])
    return lines


def table(lines: list[list[str]]) -> str:
    def line(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"
    return "<table>" + line(HEAD, "th") + "".join(line(cells, "td") for cells in lines) + "</table>"


def picture(file: Path, says: str) -> str:
    if not file.is_file():
        return ""
    data = base64.b64encode(file.read_bytes()).decode()
    return f'<p><img alt="{html.escape(says)}" src="data:image/png;base64,{data}"></p>'


def case(name: str, row: dict, pictures: Path) -> str:
    """Why a case is hard, its picture, where its limit lies, and what stopped by itself."""
    parts = [f"<h2>{html.escape(row['title'])}</h2><p>{html.escape(row['why'])} {html.escape(row['shows'])}.</p>",
             picture(pictures / f"{name}.png", row["title"])]
    if row["limit"]:
        parts.append(f"<p>Limit: {html.escape(row['limit']['where'])}. Cause: {html.escape(row['limit']['cause'])}.</p>")
    ended = [f"<li>{html.escape(run)}: {html.escape(end.get('message') or end['outcome'])}</li>"
             for run, end in row["runs"].items() if end["outcome"] != "finished"]
    return "".join(parts) + (f"<ul>{''.join(ended)}</ul>" if ended else "")


def page(result: dict, pictures: Path) -> str:
    commits = sorted({run["commit"][:7] for row in result["rows"].values() for run in row["runs"].values() if "commit" in run})
    parts = ["<h1>Hard cases</h1>",
             f"<p>{html.escape(result['verdict'])}. Measured by <code>./sprung study hard</code> at {', '.join(commits)}.</p>",
             table(table_rows(result)), "<h2>Largest stable step</h2><p><code>./sprung study stability</code>: brackets from "
             "bisection, the automatic step, and theory.</p>",
             picture(ROOT / "reports" / "figures" / "stability.png", "Largest stable step over stiffness, viscosity, spacing"),
             *(case(name, row, pictures) for name, row in result["rows"].items())]
    return f"<!doctype html><meta charset=utf-8><title>Hard cases</title><style>{STYLE}</style>" + "".join(parts)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--record", type=Path, default=ROOT / "validation" / "hard" / "records" / "hard.json")
    parser.add_argument("--pictures", type=Path, default=ROOT / "results" / "study_hard")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "hard_chapter.html")
    options = parser.parse_args()
    if not options.record.is_file():
        print(f"error: there is no {options.record}; ./sprung study hard makes one", file=sys.stderr)
        return 1
    result = json.loads(options.record.read_text())
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(page(result, options.pictures))
    for line in [HEAD, *table_rows(result)]:
        print(" | ".join(line))
    print(options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
