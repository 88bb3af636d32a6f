#!/usr/bin/python3
"""Draws the calibration: what lambda is, where it holds, how thin plates bend. Reads the tables that
`sprung-calibrate` wrote; runs no solver.

    reports/calibration_figures.py
    reports/calibration_figures.py --tables results/calibration --out results/calibration_figures
"""

import argparse
import csv
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import style

PAPER_LAMBDA = 3.23  # Monteleone et al., section 3.4, its Fig. 4
PULL, PUSH = style.RUNS["recommended"], style.RUNS["paper"]
STUDENT_T = {9: 2.262, 19: 2.093}  # 0.975 quantiles by degrees of freedom (standard tables)

GAUGES = {
    "ends": ("end layers", "o"),
    "inner": ("layers n/4 from the ends", "s"),
    "core": ("core", "^"),
}
AREAS = {"(n dx)²": 0.0, "((n − ½) dx)²": 0.5, "((n − 1) dx)²": 1.0}


def read(file: Path) -> list[dict]:
    """Rows of a table; numbers as floats. Exits with one line where the table is missing."""
    if not file.is_file():
        sys.exit(f"error: {file}: no such table; `sprung calibrate` and its subcommands write it")
    with file.open(newline="") as stream:
        # The plane (001) is a name.
        return [{k: v if k == "plane" else _number(v) for k, v in row.items()}
                for row in csv.DictReader(stream)]


def _number(text: str):
    try:
        return float(text)
    except ValueError:
        return text


def where(rows: list[dict], **wanted) -> list[dict]:
    return [row for row in rows if all(row[k] == v for k, v in wanted.items())]


def column(rows: list[dict], name: str) -> np.ndarray:
    return np.array([row[name] for row in rows])


def slope_through_origin(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Least squares y = a x, with relative weights (each point counts by its ratio): a and the half width of
    its 95 % interval."""
    ratio = y / x
    half = STUDENT_T[len(ratio) - 1] * ratio.std(ddof=1) / np.sqrt(len(ratio))
    return float(ratio.mean()), float(half)


def _legend_below(figure, axes, columns: int) -> None:
    """One legend in a strip below all panels."""
    handles, labels = axes.get_legend_handles_labels()
    strip = (0.12 + 0.2 * -(-len(labels) // columns)) / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, strip, 1, 1 - strip))
    figure.legend(handles, labels, loc="lower center", ncols=columns, borderaxespad=0.2)


# ----------------------------------------------------------------------- the paper's Fig. 4


def sweep(rows: list[dict]):
    layers = int(rows[0]["layers"])
    pulled, pushed = [where(rows, stress_pa=s) for s in (1e4, -1e4)]
    k_e = column(pulled, "k_e_pa")
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(style.WIDTH, 3.9), layout="constrained")

    def slope_by(gauge: str, less: float) -> tuple[float, float, np.ndarray]:
        # Pull and push together: their mean has no term linear in the strain.
        area = (layers / (layers - less)) ** 2
        lam = 0.5 * area * (column(pulled, f"lambda_{gauge}") + column(pushed, f"lambda_{gauge}"))
        return *slope_through_origin(k_e, lam * k_e), lam * k_e

    slope, _, modulus = slope_by("ends", 0.0)
    left.plot(1e-6 * k_e, 1e-6 * modulus, "o", color=style.REFERENCE, ms=4.5, mfc="none", label="measured")
    left.plot(1e-6 * k_e, 1e-6 * slope * k_e, "-", color=style.REFERENCE, lw=0.9,
              label=f"E = {slope:.3f} $k_e$")
    left.plot(1e-6 * k_e, 1e-6 * PAPER_LAMBDA * k_e, ":", color="grey", lw=1.6, label="paper: E = 3.23 $k_e$")
    left.set(xlabel="spring stiffness $k_e$ [MPa]", ylabel="E [MPa]",
             title=f"cube of {layers}³, ±0.01 MPa;\nend layers, area (n dx)²")
    left.legend(fontsize=7.5)

    middle.axhspan(0.99 * PAPER_LAMBDA, 1.01 * PAPER_LAMBDA, color="#dddddd", lw=0, zorder=0,
                   label="paper: 3.23 ± 1 %")
    middle.axhline(3.0, color="grey", ls=":", lw=1.2, label="bulk, derived: 3")
    for (gauge, (name, marker)), colour in zip(GAUGES.items(), (style.REFERENCE, PULL, PUSH)):
        fits = [slope_by(gauge, less)[:2] for less in AREAS.values()]
        middle.errorbar(range(len(AREAS)), [f[0] for f in fits], yerr=[f[1] for f in fits], fmt=marker, ms=4.5,
                        mfc="none", capsize=3, color=colour, label=f"strain: {name}")
    middle.set_xticks(range(len(AREAS)), [a.replace(" dx)²", "dx)²") for a in AREAS], fontsize=7.5)
    middle.set(xlabel="area of the stress", ylabel="λ = E/$k_e$, 95 % interval", xlim=(-0.5, 2.5), ylim=(2.8, 3.62),
               title="fit of the ten springs,\nby gauge and area")
    middle.legend(fontsize=7, loc="upper left")
    for rows_of_sign, colour, word in ((pulled, PULL, "pulled"), (pushed, PUSH, "pushed")):
        for gauge, (name, marker) in GAUGES.items():
            right.plot(100 * np.abs(column(rows_of_sign, "strain_ends")),
                       column(rows_of_sign, f"lambda_{gauge}"), marker + "-", color=colour, ms=4, lw=0.8,
                       mfc="none", label=f"{word}, {name}")
    right.set(xscale="log", xlabel="strain between the end layers [%]", ylabel="λ on (n dx)²",
              title="against strain: springs are linear,\nbodies are not", ylim=(2.79, 3.29))
    right.legend(fontsize=7, loc="upper left")
    return figure


# ------------------------------------------------------------------ extrapolation to the bulk


def extrapolation(pulls: list[dict], table: list[dict]):
    figure, grid = plt.subplots(1, 3, figsize=(style.WIDTH, 3.5), layout="constrained")
    cases = [((2, "equal", 0), "plane, equal bonds, pressure"),
             ((2, "isotropic", 300), "plane, isotropic, area springs 300"),
             ((3, "equal", 0), "space, equal bonds, pressure")]
    for axes, (key, title) in zip(grid, cases):
        chosen = dict(zip(("dimension", "bonds", "area_stiffness"), key))
        rows, row = where(pulls, **chosen), where(table, **chosen)[0]
        inverse = 1.0 / column(rows, "layers")
        fine = np.linspace(0, inverse.max(), 100)
        for (gauge, (name, marker)), colour in zip(GAUGES.items(), (style.REFERENCE, PULL, PUSH)):
            value = column(rows, f"lambda_{gauge}")
            axes.plot(inverse, value, marker, color=colour, ms=4.5, mfc="none", label=name)
            axes.plot(fine, np.polyval(np.polyfit(inverse, value, 2), fine), "-", color=colour, lw=0.8)
        axes.errorbar([0], [row["modulus_per_stiffness"]], yerr=[row["uncertainty"]], fmt="D", ms=4,
                      color=style.FURTHER[1], capsize=3, label="table, with uncertainty", zorder=5)
        axes.axhline(row["theory"], color="grey", ls=":", lw=1.2, label="derived")
        axes.set(xlabel="1/n", title=title, xlim=(-0.04 * inverse.max(), None))
    grid[0].set_ylabel("λ = E/$k_e$, stress on (n dx)$^{d-1}$")
    _legend_below(figure, grid[0], 5)
    return figure


# -------------------------------------------------------------------------------- direction


def polar(rows: list[dict]):
    figure, grid = plt.subplots(1, 3, figsize=(style.WIDTH, 3.7), layout="constrained",
                                subplot_kw={"projection": "polar"})
    cases = [(2, "xy", "plane", []), (3, "001", "space, in (001)", [(0, "[100]"), (45, "[110]")]),
             (3, "1-10", "space, in (1$\\bar{1}$0)", [(0, "[110]"), (35.264, "[111]"), (90, "[001]")])]
    for axes, (dimension, plane, title, marks) in zip(grid, cases):
        for bonds, colour, dash in (("equal", style.RUNS["paper"], style.DASHES["paper"]),
                                    ("isotropic", style.RUNS["recommended"], "-")):
            chosen = where(rows, dimension=dimension, plane=plane, bonds=bonds)
            angle = np.radians(np.append(column(chosen, "angle_degrees"), 360))
            value = column(chosen, "modulus_per_stiffness")
            axes.plot(angle, np.append(value, value[0]), color=colour, ls=dash, label=f"{bonds} bonds")
        axes.set_rmin(0)
        axes.set_rlabel_position(112)
        ticks = dict(marks) | {d: f"{d}°" for d in (0, 45, 90, 135, 180, 225, 270, 315)
                               if all(abs(d - m) > 15 for m, _ in marks)}
        axes.set_thetagrids(list(ticks), list(ticks.values()))
        axes.tick_params(labelsize=7)
        axes.set_title(f"λ by direction, {title}")
    _legend_below(figure, grid[0], 2)
    return figure


# ---------------------------------------------------------------------------------- bending


def bending(rows: list[dict]):
    cases = [("equal", 0, "no", "springs alone, bonds equal, not corrected", "s", style.RUNS["paper"]),
             ("isotropic", 300, "no", "area springs 300, not corrected", "^", style.FURTHER[0]),
             ("isotropic", 30, "yes", "area springs 30, corrected", "v", style.FURTHER[1]),
             ("isotropic", 300, "yes", "area springs 300, corrected", "o", style.RUNS["recommended"])]
    figure, grid = plt.subplots(1, 3, figsize=(style.WIDTH, 3.8), layout="constrained", sharex=True)
    n = np.geomspace(1.5, 36, 200)
    grid[0].plot(n, 0.75 * (n - 1) / n, ":", color="grey", lw=1.3)
    grid[0].plot(n, (n - 1) * (2 * n - 1) / (2 * n * n), "--", color="grey", lw=1)
    for text, place in (("¾ (n−1)/n", (10, 0.6)), ("(n−1)(2n−1)/(2n²)", (1.85, 0.93))):
        grid[0].annotate(text, place, fontsize=8, color="#555555", va="top",
                         bbox={"fc": "white", "ec": "none", "pad": 0.5})
    for bonds, kappa, corrected, name, marker, colour in cases:
        chosen = where(rows, dimension=2, angle_degrees=0, bend=0, bonds=bonds, area_stiffness=kappa,
                       surface_correction=corrected)
        for axes, quantity in zip(grid, ("bending", "stretching", "frequency")):
            there = [row for row in chosen if row[quantity] != ""]
            axes.plot(column(there, "layers"), column(there, quantity), marker, color=colour, ms=5,
                      mfc="none", label=name)
    for axes, title in zip(grid, ("bending stiffness EI", "stretching stiffness EA", "first frequency")):
        axes.axhspan(0.97, 1.03, color="#dddddd", lw=0, zorder=0)
        axes.set(title=f"{title} / continuum", xlabel="layers n", xscale="log", xlim=(1.7, 38), ylim=(0, 1.2))
        axes.set_xticks([2, 3, 4, 6, 8, 12, 16, 24, 32], [2, 3, 4, 6, 8, 12, 16, 24, 32])
        axes.minorticks_off()
    _legend_below(figure, grid[0], 2)
    return figure


def shapes(rows: list[dict]):
    """Corrected plates that do not lie along the lattice's axes, and plates in space."""
    cases = [(2, 0, 0, "plane, along the axes", "o"), (2, 30, 0, "plane, 30° to the axes", "x"),
             (2, 0, 0.1, "plane, arc, thickness/radius 0.1", "^"),
             (2, 0, 0.4, "plane, arc, thickness/radius 0.4", "v"),
             (3, 0, 0, "space, bar", "s"), (3, 30, 0, "space, bar, 30°", "+"),
             (3, 0, 0.2, "space, arc, thickness/radius 0.2", "D")]
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.WIDTH, 3.9), layout="constrained")
    colours = (style.RUNS["recommended"], style.RUNS["paper"], *style.FURTHER, style.REFERENCE)
    for (dimension, angle, bend, name, marker), colour in zip(cases, colours * 2):
        chosen = where(rows, dimension=dimension, bonds="isotropic", area_stiffness=300,
                       surface_correction="yes", angle_degrees=angle, bend=bend)
        left.plot(column(chosen, "layers"), column(chosen, "bending"), marker + "-", color=colour, ms=5,
                  lw=0.6, mfc="none", label=name)
    left.axhspan(0.97, 1.03, color="#dddddd", lw=0, zorder=0)
    left.set(title="bending stiffness EI / continuum, corrected", xlabel="layers n", ylim=(0.95, 1.05))
    for corrected, marker, colour in (("no", "^", style.FURTHER[0]), ("yes", "s", style.RUNS["recommended"])):
        chosen = where(rows, dimension=3, bonds="isotropic", area_stiffness=300, angle_degrees=0, bend=0,
                       surface_correction=corrected)
        word = "corrected" if corrected == "yes" else "not corrected"
        right.plot(column(chosen, "layers"), column(chosen, "bending"), marker, color=colour, ms=6,
                   mfc="none", label=f"EI, {word}")
        right.plot(column(chosen, "layers"), column(chosen, "stretching"), marker, color=colour, ms=4,
                   label=f"EA, {word}")
        if corrected == "no":
            right.plot(column(chosen, "layers"), column(chosen, "law_bending"), "--", color="grey", lw=1,
                       label="EI, law of the count of bonds")
    right.set(title="bar in space, n layers, n + 1 wide", xlabel="layers n", ylim=(0, 1.2))
    for axes in (left, right):
        axes.legend(fontsize=7, loc="lower right")
    return figure


# ---------------------------------------------------------------------------- large strains


def stress_strain(rows: list[dict], by_reference: list[dict]):
    """`by_reference`: the same stretches by finite elements; empty where they were not run."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.WIDTH, 3.9), layout="constrained")
    names = {"uniaxial": "uniaxial", "equibiaxial": "equibiaxial", "pure_shear": "pure shear",
             "simple_shear": "simple shear"}
    colours = (style.RUNS["recommended"], style.RUNS["paper"], *style.FURTHER)
    for (key, name), colour in zip(names.items(), colours):
        chosen = where(rows, dimension=3, deformation=key)
        strain = column(chosen, "stretch") - (0.0 if key == "simple_shear" else 1.0)
        lattice, solid = column(chosen, "lattice_over_g"), column(chosen, "neo_hookean_over_g")
        left.plot(100 * strain, lattice, "-", color=colour, label=f"{name}: springs")
        left.plot(100 * strain, solid, ":", color=colour, lw=1.3)
        at_rest = np.abs(solid) < 1e-9
        right.plot(100 * strain[~at_rest], (lattice / np.where(at_rest, 1, solid))[~at_rest], "-", color=colour,
                   label=name)
        judged = where(by_reference, deformation=key)
        if judged:
            strain = column(judged, "stretch") - (0.0 if key == "simple_shear" else 1.0)
            left.plot(100 * strain, column(judged, "reference_over_g"), "x", color=colour, ms=4)
            right.plot(100 * strain, column(judged, "lattice_over_g") / column(judged, "reference_over_g"), "x",
                       color=colour, ms=4)
    pulled = [row for row in where(rows, dimension=3, deformation="uniaxial") if row["bar_over_g"] != ""]
    left.plot(100 * (column(pulled, "stretch") - 1), column(pulled, "bar_over_g"), "o", color="black", ms=3.5,
              mfc="none", label="uniaxial: bar of 4 layers through the network")
    left.plot([], [], ":", color="grey", label="neo-Hookean, closed form")
    if by_reference:
        for axes in (left, right):
            axes.plot([], [], "x", color="grey", ms=4, label="neo-Hookean, finite elements")
    left.set(xlabel="strain or shear [%]", title="nominal stress / G, isotropic bonds in space", ylim=(-3, 1.7))
    right.axhline(1.0, color="grey", lw=0.8)
    right.set(xlabel="strain or shear [%]", title="springs / neo-Hookean", ylim=(0.7, 1.6))
    left.legend(fontsize=7, loc="lower right")
    right.legend(fontsize=7)
    return figure


def poisson(rows: list[dict]):
    cases = [(0, 1.0, "paper's bonds, pressure equation, h = dx", "s", style.RUNS["paper"]),
             (0, 1.3, "the same, h = 1.3 dx", "^", style.FURTHER[0]),
             (300, 0, "isotropic, volume springs 300, corrected", "o", style.RUNS["recommended"])]
    figure, axes = plt.subplots(figsize=(0.62 * style.WIDTH, 3.6), layout="constrained")
    axes.axhspan(0.495, 0.505, color="#dddddd", lw=0, zorder=0)
    for kappa, ratio, name, marker, colour in cases:
        chosen = sorted(where(rows, area_stiffness=kappa, smoothing_length_ratio=ratio), key=lambda r: r["axial_strain"])
        strain = 100 * column(chosen, "axial_strain")
        axes.plot(strain, column(chosen, "poisson_ratio"), marker, color=colour, ms=5, mfc="none", label=name)
        axes.plot(strain, column(chosen, "poisson_derived"), "-", color=colour, lw=0.9)
    axes.plot([], [], "-", color="grey", lw=0.9, label="derived")
    axes.set(xlabel="strain of the core [%]", ylabel="Poisson's ratio", title="cube under ±0.01 MPa, five springs")
    axes.legend(fontsize=7)
    return figure


def surface_layer(rows: list[dict]):
    """Error of the density below a free face beside its derived decay; Poisson's ratio by the core's depth."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.WIDTH, 3.2), layout="constrained")
    for ratio, name, marker, colour in ((1.0, "h = dx", "s", style.RUNS["paper"]), (1.3, "h = 1.3 dx", "^", style.FURTHER[0])):
        chosen = sorted(where(rows, smoothing_length_ratio=ratio, layers=28), key=lambda r: r["layers_below_face"])
        depth, error = column(chosen, "layers_below_face"), 100 * column(chosen, "density_error_over_strain")
        left.plot(depth, error, marker, color=colour, ms=5, mfc="none", label=name)
        # A decaying wave: two layers beyond the kernel's reach of the face say the rest.
        factor = chosen[0]["decay_derived"] * np.exp(2j * np.pi / chosen[0]["period_derived"])
        first = 2 if ratio == 1.0 else 3
        derived = list(error[first:first + 2])
        while len(derived) < len(error) - first:
            derived.append(2 * factor.real * derived[-1] - abs(factor) ** 2 * derived[-2])
        left.plot(depth[first:], derived, "-", color=colour, lw=0.9)
    left.plot([], [], "-", color="grey", lw=0.9, label="derived from two layers")
    left.axhline(0, color="grey", lw=0.6)
    left.set(xlabel="layers below the face", ylabel="density error [% of the strain]", title="28 layers, pulled by 0.35 %")
    left.legend(fontsize=7)
    right.axhspan(0.495, 0.505, color="#dddddd", lw=0, zorder=0)
    for layers, marker in ((10, "o"), (16, "v"), (20, "D"), (28, "s")):
        chosen = sorted(where(rows, smoothing_length_ratio=1.0, layers=layers), key=lambda r: r["layers_below_face"])
        right.plot(column(chosen, "layers_below_face"), column(chosen, "poisson_ratio"), marker + "-", ms=4, lw=0.8,
                   mfc="none", label=f"{layers} layers")
    right.set(xlabel="layers between face and core", ylabel="Poisson's ratio of the core", title="h = dx", xlim=(-0.3, 10.3))
    right.legend(fontsize=7)
    return figure


def main() -> None:
    root = Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tables", type=Path, default=root / "calibration", help="folder of the tables")
    parser.add_argument("--out", type=Path, default=root / "results" / "calibration", help="folder of the figures")
    parser.add_argument("--layers", type=int, default=20, help="which sweep: particles along the cube's edge")
    arguments = parser.parse_args()
    tables, out = arguments.tables, arguments.out
    figures = {
        "modulus_sweep": sweep(read(tables / f"sweep_{arguments.layers}.csv")),
        "modulus_extrapolation": extrapolation(read(tables / "pulls.csv"),
                                               read(tables / "modulus_per_stiffness.csv")),
        "modulus_direction": polar(read(tables / "directions.csv")),
        "bending_by_layers": bending(read(tables / "bending.csv")),
        "bending_by_shape": shapes(read(tables / "bending.csv")),
    }
    judged = tables / "stress_strain_reference.csv"  # not made where the reference is left out of the build
    if (tables / "stress_strain.csv").is_file():  # as `sprung calibrate` alone leaves a folder
        figures["stress_strain"] = stress_strain(read(tables / "stress_strain.csv"),
                                                 read(judged) if judged.is_file() else [])
    if (tables / "poisson.csv").is_file():
        figures["poisson"] = poisson(read(tables / "poisson.csv"))
    if (tables / "surface_layer.csv").is_file():
        figures["surface_layer"] = surface_layer(read(tables / "surface_layer.csv"))
    out.mkdir(parents=True, exist_ok=True)
    for name, figure in figures.items():
        figure.savefig(out / f"{name}.png")
        print(out / f"{name}.png")


if __name__ == "__main__":
    main()
