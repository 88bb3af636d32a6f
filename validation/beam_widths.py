#!/usr/bin/python3
"""Beams of 3, 4, 6 and 8 layers, E = 0.35, 0.7 and 1.4 MPa, in the channel: how far the tip of the particles is from
the finite elements' at the six times, every setting as in beam_in_channel/scene.toml.

    validation/beam_widths.py                        twelve beams, 80 s of processor time each
    validation/beam_widths.py --only 8,1.4 --seeds 4 one beam, and four more of it from a disordered start
    validation/beam_widths.py --with numerics.void_feedback=0  every beam with another setting
    validation/beam_widths.py --keep                 also puts the rows into validation/beam_in_channel/records/widths.csv

The beams are 3.75 mm per layer wide. The finite elements take steps of 2 ms: with the scene's 10 ms their own error at the
starting vibrations of the thick beams is 1.4 %. Beside the six instants stand the mean of the difference over
0.5 s < t < 3 s, which is the bias, and its standard deviation, which is mostly noise: the particles' load fluctuates and
rings the beam. A disordered start (sph.disorder = 0.05, sph.seed) is another realisation of that noise. What the same
program has answered already is not run again. Leaves OUT/widths.csv and OUT/widths.json, the manifests.
"""

import argparse
import csv
import hashlib
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
CASE = ROOT / "validation" / "beam_in_channel"
SPACING = 3.75  # mm, the scene's
TIMES = (0.2, 0.4, 0.6, 0.8, 1.0, 3.0)  # s
LAYERS, MODULI = (3, 4, 6, 8), ("0.35", "0.7", "1.4")  # MPa
REFERENCE_STEP = 'reference_fem.time_step="2 ms"'
STEADY = (0.5, 3.0)  # s; the start-up of even the softest beam has decayed in the reference
MANIFEST_KEYS = ("solver", "outcome", "start_time_utc", "version", "commit", "clean", "compiler", "compiler_flags",
                 "processor", "cores", "threads", "wall_seconds", "processor_seconds", "numbers")


def overrides(layers: int, modulus: str) -> list[str]:
    right, middle = 300 + SPACING * layers, 300 + SPACING * layers / 2
    return [f'solid.beam.body={{ from = ["0.3 m", "0 m"], to = ["{right:g} mm", "0.1 m"] }}',
            f'probes.tip.displacement_of=["{middle:g} mm", "0.1 m"]', f'solid.beam.youngs_modulus="{modulus} MPa"']


def run(command: list, folder: Path) -> dict:
    """Manifest of the record in `folder`; runs the command unless it made that record already."""
    asked = folder.with_name(folder.name + ".asked")
    program = hashlib.sha256(Path(command[0]).read_bytes()).hexdigest()
    wanted = "\n".join([program, hashlib.sha256((CASE / "scene.toml").read_bytes()).hexdigest(), *map(str, command[1:])])
    manifest = folder / "manifest.json"
    if not (manifest.exists() and asked.exists() and asked.read_text() == wanted
            and json.loads(manifest.read_text())["outcome"] == "finished"):
        folder.parent.mkdir(parents=True, exist_ok=True)
        asked.write_text(wanted)
        code = subprocess.run([*map(str, command), "--out", str(folder), "--overwrite", "--threads", "1"],
                              stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL).returncode
        if code not in (0, 3):  # 3: it stopped itself, its record is valid
            sys.exit(f"error: {folder}: the solver failed with exit code {code}: {' '.join(map(str, command))}")
    return json.loads(manifest.read_text())


def tip(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    table = np.loadtxt(folder / "probes" / "tip.csv", delimiter=",", skiprows=1)
    return table[:, 0], table[:, 1]


def row_of(layers: int, modulus: str, seed: int, setting: str, particles: Path, reference: Path, manifest: dict) -> dict:
    time, found = tip(particles)
    true_time, true = tip(reference)
    row = {"layers": layers, "youngs_modulus_mpa": modulus, "seed": seed, "with": setting}
    for t in TIMES:
        reached = time[-1] > t - 1e-9
        row[f"difference_{t:g}s_percent"] = (
            f"{100 * (np.interp(t, time, found) / np.interp(t, true_time, true) - 1):+.2f}" if reached else "")
    late = (time > STEADY[0]) & (time < STEADY[1])
    difference = 100 * (found[late] / np.interp(time[late], true_time, true) - 1)
    row |= {"mean_difference_percent": f"{difference.mean():+.2f}", "noise_percent": f"{difference.std(ddof=1):.2f}",
            "tip_reference_3s_m": f"{true[-1]:.6g}", "outcome": manifest["outcome"].split(",")[0],
            "processor_seconds": f"{manifest['processor_seconds']:.1f}", "commit": manifest["commit"][:7]}
    return row


def write(folder: Path, rows: list[dict], manifests: dict) -> None:
    """Puts the rows into the folder's table in the place of those of the same beam, seed and setting, and their manifests."""
    def key(row: dict) -> tuple:
        return row.get("with", ""), int(row["layers"]), float(row["youngs_modulus_mpa"]), int(row["seed"])

    table, book = folder / "widths.csv", folder / "widths.json"
    present = {}
    if table.is_file():
        with table.open(newline="") as stream:
            present = {key(row): row for row in csv.DictReader(stream)}
        manifests = json.loads(book.read_text())["runs"] | manifests
    present |= {key(row): row for row in rows}
    with table.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]), restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(present[k] for k in sorted(present))
    book.write_text(json.dumps({"command": "validation/beam_widths.py --keep, --with as the row says",
                                "runs": {name: manifests[name] for name in sorted(manifests)}}, indent=1) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/bin/sprung-sph")
    parser.add_argument("--reference", type=Path, default=ROOT / "build/release/bin/sprung-reference")
    parser.add_argument("--out", type=Path, default=ROOT / "results/beam_widths")
    parser.add_argument("--only", action="append", metavar="LAYERS,MPA", help="this beam only; may be repeated")
    parser.add_argument("--seeds", type=int, default=0, help="so many further runs of each beam, disordered")
    parser.add_argument("--with", dest="settings", action="append", default=[], metavar="TABLE.KEY=VALUE",
                        help="an override for every run of particles; may be repeated")
    parser.add_argument("--keep", action="store_true", help="write the table to the case's records too")
    options = parser.parse_args()
    beams = [(n, e) for n in LAYERS for e in MODULI if not options.only or f"{n},{e}" in options.only]
    if not beams:
        parser.error(f"--only: no such beam; layers are one of {LAYERS}, E one of {', '.join(MODULI)} MPa")
    out, rows, manifests = options.out.resolve(), [], {}
    out.mkdir(parents=True, exist_ok=True)
    for layers, modulus in beams:
        folder, scene = out / f"{layers}_layers_{modulus}_MPa", [CASE / "scene.toml", *overrides(layers, modulus)]
        truth = folder / "reference"
        manifests[f"{layers},{modulus},reference"] = run([options.reference, *scene, REFERENCE_STEP], truth)
        for seed in range(options.seeds + 1):
            start = [f"sph.seed={seed}", "sph.disorder=0.05"] if seed else []
            record = folder / "_".join(["particles", str(seed), *options.settings])
            manifest = run([options.program, "run", *scene, *start, *options.settings], record)
            manifests[",".join([str(layers), modulus, str(seed), *options.settings])] = manifest
            rows.append(row_of(layers, modulus, seed, " ".join(options.settings), record, truth, manifest))
            print(*rows[-1].values(), sep="  ", flush=True)
    kept = {name: {key: manifest.get(key) for key in MANIFEST_KEYS} for name, manifest in manifests.items()}
    for folder in [out] + ([CASE / "records"] if options.keep else []):
        write(folder, rows, kept)
    return 0


if __name__ == "__main__":
    sys.exit(main())
