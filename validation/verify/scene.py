"""A scene as the solver resolved it (manifest.json's scene_toml), in SI, for the exact solutions."""

import ast
import math
import sys
import tomllib
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scene"))

from record import quantity  # noqa: E402


class SceneMismatch(Exception):
    """The scene is not the one that an exact solution or a check is meant for."""


FUNCTIONS = {name: getattr(math, name) for name in
             ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "sqrt", "log")} | {"min": min, "max": max, "abs": abs}


def formula_value(formula: str, **variables: float) -> float:
    """Value of a scene's formula; knows + - * / ^, pi and the functions above, and nothing else."""
    tree = ast.parse(formula.replace("^", "**").replace("_pi", "pi"), mode="eval")
    names = {"pi": math.pi, **variables}

    def value(node):
        match node:
            case ast.Expression(body=body):
                return value(body)
            case ast.Constant(value=number) if isinstance(number, (int, float)):
                return float(number)
            case ast.Name(id=name) if name in names:
                return names[name]
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return -value(inner)
            case ast.BinOp(left=left, op=op, right=right):
                a, b = value(left), value(right)
                match op:
                    case ast.Add():
                        return a + b
                    case ast.Sub():
                        return a - b
                    case ast.Mult():
                        return a * b
                    case ast.Div():
                        return a / b
                    case ast.Pow():
                        return a**b
            case ast.Call(func=ast.Name(id=name), args=arguments) if name in FUNCTIONS:
                return FUNCTIONS[name](*(value(one) for one in arguments))
        raise SceneMismatch(f"cannot read the formula {formula!r}")

    return value(tree)


class Scene:
    def __init__(self, table: dict):
        self.table = table

    @classmethod
    def of_toml(cls, text: str) -> "Scene":
        return cls(tomllib.loads(text))

    def entry(self, path: str):
        here = self.table
        for word in path.split("."):
            if not isinstance(here, dict) or word not in here:
                raise SceneMismatch(f"the scene has no {path}")
            here = here[word]
        return here

    def has(self, path: str) -> bool:
        try:
            self.entry(path)
        except SceneMismatch:
            return False
        return True

    def text(self, path: str) -> str:
        return str(self.entry(path))

    def number(self, path: str) -> float:
        value = self.entry(path)
        return quantity(value) if isinstance(value, str) else float(value)

    def vector(self, path: str) -> np.ndarray:
        """Three components; the third is 0 in a plane scene."""
        values = [quantity(text) for text in self.entry(path)]
        return np.array(values + [0.0] * (3 - len(values)))

    @property
    def dimension(self) -> int:
        return len(self.entry("domain.channel.from"))

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        return self.vector("domain.channel.from"), self.vector("domain.channel.to")

    @property
    def kinematic_viscosity(self) -> float:
        return self.number("viscosity.dynamic") / self.number("fluid.density")

    @property
    def spacing(self) -> float:
        return self.number("sph.spacing")

    def expect_waveform(self, table: str, wanted) -> None:
        """Refuses a scene whose [table] waveform is not `wanted`, a function of time; none means 1."""
        formula = self.entry(table).get("waveform", {}).get("formula", "1")
        for t in (0.0, 0.013, 0.37, 1.1):
            if abs(formula_value(formula, t=t) - wanted(t)) > 1e-9:
                raise SceneMismatch(f"[{table}] has the waveform {formula!r}, which the exact solution is not for")
