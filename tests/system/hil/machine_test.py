#!/usr/bin/env python3
"""The machine itself, running: it gives exit codes and output as they are, keeps time limits, and goes on afterwards."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

MACHINE = pathlib.Path(__file__).resolve().parent / "machine.py"


def run(*command, folder=None, seconds=30):
    arguments = ["run", "--seconds", str(seconds), folder or FOLDER, *command]
    return subprocess.run([sys.executable, MACHINE, *arguments], capture_output=True, text=True, timeout=100)


class Machine(unittest.TestCase):
    def test_gives_exit_code_and_output(self):
        done = run("bash", "-c", "echo to stdout; echo to stderr >&2; exit 3")
        self.assertEqual(done.returncode, 3)
        self.assertIn("to stdout\nto stderr\n", done.stdout)

    def test_takes_arguments_as_they_are(self):
        awkward = "two  words; $HOME `id` 'quoted' \"twice\" *"
        self.assertIn(awkward + "\n", run("printf", r"%s\n", awkward).stdout)

    def test_keeps_time_limits_and_goes_on(self):
        done = run("sleep", "300", seconds=1)
        self.assertEqual(done.returncode, 124)
        self.assertIn("time limit", done.stdout)  # of the machine, not of who waits for it
        self.assertEqual(run("true").returncode, 0)

    def test_kills_what_does_not_end_when_told_to(self):
        done = run("bash", "-c", "trap '' TERM; while :; do :; done", seconds=1)
        self.assertIn(done.returncode, (124, 137))
        self.assertEqual(run("true").returncode, 0)

    def test_writes_to_its_folder_only(self):
        inside, outside = FOLDER / "written", MACHINE.parent / "written"
        self.assertEqual(run("bash", "-c", f"echo here >'{inside}'").returncode, 0)
        self.assertEqual(inside.read_text(), "here\n")
        if (FOLDER / "kind").read_text() == "virtual":
            self.assertNotEqual(run("touch", str(outside)).returncode, 0)
            self.assertFalse(outside.exists())

    def test_says_that_there_is_no_machine(self):
        with tempfile.TemporaryDirectory() as empty:
            done = run("true", folder=empty)
        self.assertEqual(done.returncode, 125)
        self.assertIn("boot it first", done.stdout)


if __name__ == "__main__":
    FOLDER = pathlib.Path(sys.argv.pop(1)).resolve()
    if (FOLDER / "skipped").exists():
        print((FOLDER / "skipped").read_text())
        sys.exit(77)
    unittest.main()
