#!/usr/bin/env python3
"""memory_test.py ROOT BIN: what is told of a program's memory is its own, whatever started it.

The system's count (ru_maxrss) of a process begins at what it was before it became the program: a copy of this one,
made large here. The small problems need far less.
"""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

ROOT, BIN = Path(sys.argv[1]), Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "validation" / "study"))

import block_point  # noqa: E402

LAUNCHER = 512_000_000
BALLAST = bytearray(b"x") * LAUNCHER  # every page written to


class Memory(unittest.TestCase):
    def block(self, solver: str, program: str, *overrides: str) -> dict:
        plan = SimpleNamespace(case=SimpleNamespace(name="cube"), quantities={"strain": {}})
        point = SimpleNamespace(name="block", solver=solver, overrides=overrides)
        with tempfile.TemporaryDirectory(prefix="sprung_memory_") as folder:
            out = Path(folder) / "answer.json"
            self.assertEqual(block_point.run(plan, point, 1, BIN / program, out), 0)
            return block_point.json.loads(out.read_text())

    def own(self, memory: float) -> None:
        self.assertGreater(memory, 5e6)  # a program of this kind maps more than that before it computes
        self.assertLess(memory, 0.5 * LAUNCHER)

    def test_a_block_of_particles_counts_its_own(self):
        self.own(self.block("particles", "sprung-calibrate", "--layers=4")["peak_memory_bytes"])

    @unittest.skipUnless((BIN / "sprung-reference-solid").is_file(), "the reference is not built")
    def test_a_block_of_finite_elements_counts_its_own(self):
        answer = self.block("reference", "sprung-reference-solid", "--youngs-modulus=3e6", "--cells=1 1 1",
                            "--stress=1000 0 0")
        self.own(answer["peak_memory_bytes"])

    def test_explain_tells_its_own(self):
        scene = ROOT / "validation" / "taylor_green" / "scene.toml"
        told = subprocess.run([BIN / "sprung-sph", "explain", scene, 'sph.spacing="50 mm"'], capture_output=True, text=True,
                              check=True).stdout
        self.own(1e6 * float(re.search(r"(\d+) MB of memory", told)[1]))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
