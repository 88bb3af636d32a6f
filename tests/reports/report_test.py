#!/usr/bin/env python3
"""report_test.py PROGRAMS REPORTS ACCEPTANCE: from records to the page in the browser.

Records are made from formulas by PROGRAMS/synthetic_records, compared by PROGRAMS/sprung-compare, drawn by
REPORTS/report.py and opened in Chromium. The checker itself is tried on a broken page first: a check that
cannot fail shows nothing.
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import opens_in_browser

PROGRAMS, REPORTS, ACCEPTANCE = (Path(a) for a in sys.argv[1:4])
FIGURES = ["beams_and_profiles", "field", "displacement", "force", "ledgers", "cost"]


def run(*command) -> subprocess.CompletedProcess:
    return subprocess.run([str(part) for part in command], capture_output=True, text=True)


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="sprung_report_")
        cls.folder = Path(cls.temporary.name)
        subprocess.run([PROGRAMS / "synthetic_records", cls.folder], check=True)
        cls.compared = run(PROGRAMS / "sprung-compare", cls.folder / "reference", cls.folder / "runs/recommended",
                           cls.folder / "runs/paper", "--acceptance", ACCEPTANCE, "--out", cls.folder)
        cls.drawn = run("/usr/bin/python3", REPORTS / "report.py", cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_every_picture_shows_and_the_console_is_clean(self):
        self.assertEqual(self.drawn.returncode, 0, self.drawn.stderr)
        self.assertEqual(opens_in_browser.faults_of(self.folder / "report.html", FIGURES), [])

    def test_the_check_sees_a_broken_page(self):
        broken = self.folder / "broken.html"
        broken.write_text('<!DOCTYPE html><link rel="icon" href="data:,"><figure id="field">'
                          '<img alt="a picture that is not there at all" src="data:image/png;base64,AAAA"></figure>'
                          '<script>throw new Error("on purpose")</script>')
        faults = "\n".join(opens_in_browser.faults_of(broken, ["field", "cost"]))
        self.assertIn("'field' is not there", faults)
        self.assertIn("'cost' is missing", faults)
        self.assertIn("on purpose", faults)

    def test_the_verdicts_of_the_comparison_stand_on_the_page(self):
        self.assertEqual(self.compared.returncode, 0, self.compared.stdout + self.compared.stderr)
        page = (self.folder / "report.html").read_text()
        comparison = json.loads((self.folder / "comparison.json").read_text())
        judged = [m for r in comparison["runs"] for m in r["measurements"] if m["verdict"] in ("pass", "fail")]
        self.assertEqual(page.count("✓ pass") + page.count("✗ fail"), len(judged))
        self.assertIn("Within the acceptance", page)
        self.assertIn("stopped: made up", page)

    def test_a_report_of_nothing_is_refused(self):
        with tempfile.TemporaryDirectory() as empty:
            answer = run("/usr/bin/python3", REPORTS / "report.py", empty)
            self.assertNotEqual(answer.returncode, 0)
            self.assertIn("comparison.json", answer.stderr)
            self.assertEqual(list(Path(empty).iterdir()), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
