#!/usr/bin/env python3
"""Which kind of machine is booted, of what this kernel and the tools are said to lack."""
import pathlib
import tempfile
import unittest

import machine
import machine_kinds


def has_all():
    return None


def lacks(what):
    return lambda: what


def not_asked():
    raise AssertionError("asked, though it decides nothing")


class Choice(unittest.TestCase):
    def refused(self, *arguments):
        with self.assertRaises(machine.MachineError) as caught:
            machine.choose(*arguments)
        return caught.exception.code, str(caught.exception)

    def test_takes_this_kernel_if_it_has_what_it_takes(self):
        kind, why = machine.choose("", has_all, not_asked)
        self.assertEqual(kind, "native")
        self.assertIn("this kernel has what it takes", why)

    def test_boots_a_virtual_machine_if_this_kernel_lacks_something_and_says_what(self):
        self.assertEqual(machine.choose("", lacks("no vcan"), has_all), ("virtual", "no vcan"))

    def test_skips_if_neither_can_be_and_says_why_of_both(self):
        code, said = self.refused("", lacks("no vcan"), lacks("no QEMU"))
        self.assertEqual(code, machine.SKIPPED)
        self.assertIn("no QEMU", said)
        self.assertIn("no vcan", said)

    def test_boots_a_virtual_machine_if_asked_whatever_this_kernel_has(self):
        self.assertEqual(machine.choose("virtual", not_asked, has_all), ("virtual", "OCTOSKIN_HIL=virtual"))

    def test_takes_this_kernel_if_asked(self):
        self.assertEqual(machine.choose("native", has_all, not_asked), ("native", "OCTOSKIN_HIL=native"))

    def test_skips_what_was_asked_for_and_cannot_be_rather_than_take_the_other(self):
        self.assertEqual(self.refused("native", lacks("no vcan"), not_asked),
                         (machine.SKIPPED, "skipped: OCTOSKIN_HIL=native, but no vcan"))
        self.assertEqual(self.refused("virtual", not_asked, lacks("no QEMU")), (machine.SKIPPED, "skipped: no QEMU"))

    def test_refuses_a_kind_that_it_does_not_know(self):
        code, said = self.refused("qemu", not_asked, not_asked)
        self.assertEqual(code, machine.BROKEN)
        self.assertIn("OCTOSKIN_HIL=qemu", said)


class Folder(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name) / "boards"

    def test_is_made_or_made_anew_where_a_machine_was(self):
        for left in (None, "kind", "skipped", "pid"):
            if left:
                (self.folder / left).write_text("0")
            machine.make_anew(self.folder)
            self.assertEqual(list(self.folder.iterdir()), [])

    def test_of_something_else_is_not_touched(self):
        self.folder.mkdir()
        (self.folder / "thesis.tex").write_text("years")
        with self.assertRaises(machine.MachineError) as raised:
            machine.make_anew(self.folder)
        self.assertIn(str(self.folder), str(raised.exception))
        self.assertEqual((self.folder / "thesis.tex").read_text(), "years")

    def test_that_cannot_be_removed_is_an_error_that_names_it(self):
        self.folder.write_text("a file of this name")
        with self.assertRaises(machine.MachineError) as raised:
            machine.make_anew(self.folder)
        self.assertIn(str(self.folder), str(raised.exception))


class ExitCode(unittest.TestCase):
    def test_of_what_a_signal_ended_is_the_shells(self):
        self.assertEqual([machine_kinds.as_a_shell_gives_it(code) for code in (0, 1, 77, -9, -15)], [0, 1, 77, 137, 143])


if __name__ == "__main__":
    unittest.main()
