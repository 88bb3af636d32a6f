#!/usr/bin/env python3
"""report.py FOLDER: draws report.html from FOLDER/comparison.json and the records it names.

Reads records and tables, draws, and never runs a solver. The page holds its pictures inside; the same
pictures stand in FOLDER/figures as PNG files.
"""

import base64
import io
import json
import os
import sys
import tomllib
from pathlib import Path

import jinja2
import matplotlib.pyplot as plt

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "scene"))  # the reader stands beside the writer

import figures  # noqa: E402
from record import Record, quantity  # noqa: E402
from tables import Tables  # noqa: E402


def probes_of(scene: dict) -> dict[str, list[str]]:
    kinds = {"displacement_of": "displacement", "velocity_along": "profile", "force_on": "force",
             "outline_of": "outline"}
    found: dict[str, list[str]] = {kind: [] for kind in kinds.values()}
    for name, probe in scene.get("probes", {}).items():
        for key, kind in kinds.items():
            if key in probe:
                found[kind].append(name)
    return found


def read_sides(folder: Path) -> figures.Sides:
    comparison = json.loads((folder / "comparison.json").read_text())
    reference = Record(folder / comparison["reference"]["folder"], "reference")
    runs = [Record(folder / run["folder"], run["run"]) for run in comparison["runs"]]
    scene = tomllib.loads(reference.manifest["scene_toml"])
    box = scene["domain"]["channel"]
    channel = tuple(quantity(text) for text in (*box["from"][:2], *box["to"][:2]))
    spacing = {}
    for run in runs:
        text = tomllib.loads(run.manifest["scene_toml"]).get("sph", {}).get("spacing")
        spacing[run.label] = quantity(text) if text else 0.0
    return figures.Sides(reference, runs, channel, spacing, comparison, probes_of(scene))


def write_whole(file: Path, content: bytes) -> None:
    beside = file.with_name(file.name + ".new")
    beside.write_bytes(content)
    os.replace(beside, file)


def draw_all(sides: figures.Sides, folder: Path) -> list[dict]:
    """Draws every figure that the records allow, leaves it as a PNG file, and returns what the page needs."""
    folder.mkdir(exist_ok=True)
    drawn = []
    for draw in figures.ALL:
        picture = draw(sides)
        if picture is None:
            continue
        buffer = io.BytesIO()
        picture.figure.savefig(buffer, format="png")
        plt.close(picture.figure)
        write_whole(folder / f"{picture.name}.png", buffer.getvalue())
        drawn.append({
            "name": picture.name,
            "alternative": picture.alternative,
            "caption": picture.caption,
            "data": base64.b64encode(buffer.getvalue()).decode(),
        })
    return drawn


def render(sides: figures.Sides, drawn: list[dict]) -> str:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE), autoescape=True, trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    return environment.get_template("report.html.j2").render(
        comparison=sides.comparison,
        pictures=drawn,
        tables=Tables(sides),
        records=[sides.reference, *sides.runs],
        title_of=lambda record: figures.title_of(record, sides),
    )


def main(arguments: list[str]) -> int:
    if len(arguments) != 1 or arguments[0] in ("-h", "--help"):
        print(__doc__.strip(), file=sys.stderr)
        return 0 if arguments and arguments[0] in ("-h", "--help") else 2
    folder = Path(arguments[0])
    if not (folder / "comparison.json").is_file():
        print(f"report: {folder} holds no comparison.json; ./sprung validate makes one", file=sys.stderr)
        return 2
    try:
        sides = read_sides(folder)
    except OSError as error:
        print(f"report: a record cannot be read: {error}", file=sys.stderr)
        return 2
    except (ValueError, KeyError, TypeError) as error:
        print(f"report: {folder} holds a comparison or a record that is damaged or of another version ({type(error).__name__}: "
              f"{error}); ./sprung validate CASE --out {folder} makes it again", file=sys.stderr)
        return 2
    drawn = draw_all(sides, folder / "figures")
    write_whole(folder / "report.html", render(sides, drawn).encode())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
