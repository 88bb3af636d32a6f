#!/usr/bin/env python3
"""absence_test.py ALONE LINKED: an effect that a scene does not name costs nothing.

ALONE and LINKED are one program, the step of a fluid; LINKED has the code of every effect in it, ALONE only what the
step names. Both must take the same number of instructions, by valgrind's callgrind, in the step, and give the same
bits; both make the same number of allocations.
"""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ALONE, LINKED = Path(sys.argv[1]), Path(sys.argv[2])
# Effects that this fluid does not name; each is a class that LINKED must hold and ALONE must not.
# (Carreau-Yasuda's law is compiled beside the constant one's and is in both.)
ABSENT = ["GravityEffect", "MovingWalls", "ShiftingEffect", "Stiffening", "Viscoelastic", "ElasticSolid"]
# Bound at the start: a larger program's symbols take longer to find, which is not the step's work.
ENVIRONMENT = {"LD_BIND_NOW": "1", "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive", "PATH": "/usr/bin:/bin"}


def symbols(program: Path) -> str:
    return subprocess.run(["nm", "-C", program], capture_output=True, text=True, check=True).stdout


def instructions_and_answer(program: Path) -> tuple[int, str]:
    """Instructions of the program's own code within advance<2>, and what the program printed.

    The C library's are not counted: how long malloc searches depends on what the set-up left behind.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/out"
        answer = subprocess.run(["valgrind", "--tool=callgrind", "--toggle-collect=*advance<2>*",
                                 f"--callgrind-out-file={file}", program.resolve()],
                                capture_output=True, text=True, env=ENVIRONMENT, check=True)
        table = subprocess.run(["callgrind_annotate", "--threshold=100", "--auto=no", file], capture_output=True,
                               text=True, env=ENVIRONMENT, check=True).stdout
        own = re.findall(rf"^\s*([0-9,]+) \(.*\[{re.escape(str(program.resolve()))}\]$", table, re.MULTILINE)
        return sum(int(count.replace(",", "")) for count in own), answer.stdout


class Absence(unittest.TestCase):
    def test_one_program_has_the_effects_and_the_other_has_not(self):
        alone, linked = symbols(ALONE), symbols(LINKED)
        for name in ABSENT:
            self.assertTrue(re.search(rf"\b{name}\b", linked), f"{name} is not in {LINKED.name}")
            self.assertFalse(re.search(rf"\b{name}\b", alone), f"{name} is in {ALONE.name}")

    def test_allocations_of_a_step_are_the_same(self):
        counts = []
        for program in (ALONE, LINKED):
            said = subprocess.run([program.resolve()], capture_output=True, text=True, env=ENVIRONMENT, check=True).stdout
            counts.append(int(re.search(r"^allocations (\d+)$", said, re.MULTILINE)[1]))
        print(f"{counts[0]} and {counts[1]} calls of operator new in three steps")
        self.assertEqual(*counts)

    def test_instructions_and_bits_are_the_same(self):
        alone, said = instructions_and_answer(ALONE)
        linked, said_linked = instructions_and_answer(LINKED)
        print(f"{alone} and {linked} instructions in six steps of 256 particles; {said.split()}")
        self.assertGreater(alone, 256 * 6 * 20 * 10, "fewer than one instruction or so a pair: the step was not counted")
        self.assertEqual(alone, linked)
        self.assertEqual(said, said_linked)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
