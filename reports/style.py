"""Colours, line styles and sizes that every figure shares."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)

REFERENCE = "#1a1a1a"
# Told apart by readers with any colour vision, and by their dashes in grey print.
RUNS = {"recommended": "#c1272d", "paper": "#0072b2"}
FURTHER = ["#e69f00", "#009e73", "#cc79a7", "#56b4e9"]
DASHES = {"recommended": "-", "paper": (0, (4, 1.5))}
WIDTH = 9.0  # inches
DPI = 150

plt.rcParams.update(
    {
        "font.size": 9,
        "axes.titlesize": 9.5,
        "axes.titlelocation": "left",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.linewidth": 0.7,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": "#e3e3e3",
        "grid.linewidth": 0.6,
        "lines.linewidth": 1.3,
        "legend.frameon": False,
        "figure.dpi": DPI,
        "savefig.dpi": DPI,
        "savefig.facecolor": "white",
    }
)


def save(figure, file: Path) -> None:
    """Whole or not at all: written beside the file, then put in its place."""
    beside = file.with_name("new_" + file.name)
    figure.savefig(beside)
    plt.close(figure)
    beside.replace(file)


def colour(label: str, position: int) -> str:
    return RUNS.get(label, FURTHER[position % len(FURTHER)])


def dashes(label: str):
    return DASHES.get(label, "-")
