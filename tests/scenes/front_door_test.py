#!/usr/bin/env python3
"""front_door_test.py ROOT: what `sprung` says and how it fails, without building anything."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(sys.argv[1])
VERBS = ["check", "explain", "run", "reference", "calibrate", "validate", "study", "recommend", "report", "test"]
WRONG_USE, NOT_THERE, NO_BUILD = 2, 4, 5


def sprung(*arguments, cwd="/", door=ROOT / "sprung"):
    # Packages are not this test's business, and a build would wait for the one that runs it.
    return subprocess.run([str(door), *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=30,
                          env={**os.environ, "SPRUNG_SKIP_PACKAGES": "1"})


class FrontDoorTest(unittest.TestCase):
    def test_help_names_every_verb(self):
        answer = sprung("--help")
        self.assertEqual(answer.returncode, 0)
        for verb in VERBS:
            self.assertIn(f"\n  {verb} ", answer.stdout)

    def test_every_verb_has_help_with_an_example(self):
        for verb in VERBS:
            for arguments in ((verb, "--help"), (verb, "-h")):
                with self.subTest(arguments):
                    answer = sprung(*arguments)
                    self.assertEqual(answer.returncode, 0, answer.stderr)
                    self.assertTrue(answer.stdout.startswith(f"./sprung {verb}"))
                    self.assertIn(f"\n  ./sprung {verb}", answer.stdout)

    def test_wrong_use_is_told_with_a_remedy(self):
        for arguments, says in (
            ((), "./sprung VERB"),
            (("frobnicate",), "'frobnicate'"),
            (("--frobnicate", "test"), "'--frobnicate'"),
            (("validate",), "beam_in_channel"),
            (("validate", "beam_in_channel", "--quik"), "'--quik'"),
            (("validate", "beam_in_channel", "--out"), "--out needs"),
            (("validate", "beam_in_channel", "--threads", "two"), "'two'"),
            (("validate", "beam_in_channel", "--skip", "papre"), "'papre'"),
            (("validate", "beam_in_channel", "--time-limit", "paper"), "RUN=SECONDS"),
            (("report",), "--help"),
            (("report", "/nowhere"), "comparison.json"),
            (("report", ""), "takes the folder"),
            (("validate", "beam_in_channel", "--against", "README.md"), "no baseline can be read there"),
            (("validate", "beam_in_channel", "--against", "validation/beam_in_channel/baseline/quick.json"), "of level quick"),
            (("validate", "beam_in_channel", "--quick", "--against", "validation/beam_in_channel/records/cost_study.json"),
             "is no baseline"),
            (("recommend", "beam_in_channel", "--check", "hydrostatics"), "hydrostatics/cost.toml"),
            (("recommend", "beam_in_channel", "--error", "-3%"), "not '-3%'"),
            (("recommend", "beam_in_channel", "--error", "1.2.3"), "not '1.2.3'"),
            (("recommend", "beam_in_channel", "--time", "-5s"), "not '-5s'"),
            (("recommend", "all", "--error", "-1%"), "not '-1%'"),
            (("study",), "numerics"),
            (("study", "cost", "hydrostatics"), "beam_in_channel"),
            (("recommend", "hydrostatics"), "beam_in_channel"),
            (("test", "--label"), "one of: quick"),
            (("test", "--label", "quik"), "'quik'"),
            (("--no-reference", "reference", "scene.toml"), "--no-reference"),
        ):
            with self.subTest(arguments):
                answer = sprung(*arguments, cwd=ROOT)
                self.assertEqual(answer.returncode, WRONG_USE, answer.stderr)
                self.assertIn(says, answer.stderr)
                self.assertNotIn("Traceback", answer.stderr)

    def test_a_damaged_comparison_is_told(self):
        for text in ("", "{}", "[1]", '{"reference": {"folder": "reference"}, "runs": []}', "\xff\xfe"):
            with tempfile.TemporaryDirectory() as folder, self.subTest(text):
                (Path(folder) / "comparison.json").write_text(text, encoding="latin-1")
                answer = sprung("report", folder)
                self.assertEqual(answer.returncode, WRONG_USE, answer.stderr)
                self.assertIn(folder, answer.stderr)
                self.assertNotIn("Traceback", answer.stderr)

    def test_what_is_not_there_yet_says_so(self):
        for arguments, says in ((("study", "accuracy_against_cost"), "accuracy_against_cost"),
                                (("validate", "aortic_valve"), "aortic_valve")):
            with self.subTest(arguments):
                answer = sprung(*arguments)
                self.assertEqual(answer.returncode, NOT_THERE, answer.stderr)
                self.assertIn(says, answer.stderr)

    def test_packages_of_a_group_are_installed_for_what_asks_for_them_alone(self):
        missing = ["ninja-build", "slurmctld", "slurmd", "slurm-client", "munge"]
        fakes = {"dpkg-query": f'for p in "$@"; do case " {" ".join(missing)} " in *" $p "*) ;; *) echo "installed $p" ;; esac; done',
                 "apt-get": f'[ "$1" = update ] || {{ echo "$@" >&2; exit 1; }}', "sudo": '"$@"'}
        with tempfile.TemporaryDirectory() as folder:
            for name, text in fakes.items():
                fake = Path(folder) / name
                fake.write_text(f"#!/bin/sh\n{text}\n")
                fake.chmod(0o755)
            environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}
            environment.pop("SPRUNG_SKIP_PACKAGES", None)
            for options, wanted in (((), missing[:1]), (("--label", "stability"), missing[:1]),
                                    (("--label", "cluster"), missing), (("--all",), missing)):
                with self.subTest(options):
                    answer = subprocess.run([ROOT / "sprung", "test", *options], capture_output=True, text=True, timeout=30,
                                            env=environment)
                    self.assertEqual(answer.returncode, NO_BUILD, answer.stderr)
                    asked = answer.stderr.splitlines()[0].split("installing Debian packages: ")[1].split()
                    self.assertEqual(sorted(asked), sorted(wanted))

    def test_the_exit_code_of_what_is_watched_over_gets_through(self):
        script = """set -euo pipefail; eval "$(sed -n '/^watch_over()/,/^}/p' "$1")"; (exit 6) & watch_over $!; wait $watched"""
        answer = subprocess.run(["bash", "-c", script, "bash", ROOT / "sprung"], capture_output=True, text=True, timeout=30)
        self.assertEqual(answer.returncode, 6, answer.stderr)

    def test_works_through_a_link_from_any_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            link = Path(folder) / "door"
            link.symlink_to(ROOT / "sprung")
            answer = sprung("validate", "nothing", cwd=folder, door=link)
            self.assertIn("beam_in_channel", answer.stderr)
            self.assertEqual([p.name for p in Path(folder).iterdir()], ["door"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
