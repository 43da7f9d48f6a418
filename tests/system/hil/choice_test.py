#!/usr/bin/env python3
"""Which kind of machine is booted, of what this kernel and the tools are said to lack."""
import unittest

import machine


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


if __name__ == "__main__":
    unittest.main()
