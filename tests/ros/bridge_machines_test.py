#!/usr/bin/env python3
"""octoskin's bridge on two machines joined by a cable: the programs of another maker have no settings.

usage: bridge_machines_test.py FOLDER_OF_PROGRAMS [unittest's arguments]      skipped where namespaces are not allowed
"""
import sys
import time
import unittest

import namespaces
from bridge_world import World
from programs import Programs, wait_for

SCENE = ("/planning_scene", "moveit_msgs/PlanningScene")


class Machines(unittest.TestCase):
    def setUp(self):
        try:
            self.one, self.two = self.enterContext(namespaces.TwoMachines())
        except RuntimeError as error:
            self.skipTest(str(error))

    def bridge(self, *options, **environment):
        """The bridge is on machine one."""
        return self.enterContext(World(FOLDER, bridge_options=options, prefix=self.one.prefix, domain=0,
                                       environment=environment))

    def listen(self, machine, *options):
        return self.enterContext(Programs(FOLDER, domain=0, prefix=machine.prefix).start_listening(*options, *SCENE))

    def scenes_of_both(self, seconds, count=3):
        """On the two machines at once."""
        listening = [self.listen(machine, "--seconds", seconds, "--count", count) for machine in (self.one, self.two)]
        return tuple(len(one.finish("sample")) for one in listening)

    def test_by_default_both_machines_find_it(self):
        self.bridge()
        self.assertEqual(self.scenes_of_both(15), (3, 3))

    def test_loopback_only_is_found_by_neither(self):
        """An unconfigured program on the same machine uses the cable's address."""
        self.bridge(ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST")
        self.assertEqual(self.scenes_of_both(5), (0, 0))

    def test_this_machine_only_is_found_here_and_sends_nothing_there(self):
        world = self.bridge("--this-machine-only")
        self.assertEqual(len(self.listen(self.one, "--seconds", 15, "--count", 3).finish("sample")), 3)
        self.assertTrue(wait_for(lambda: world.bridge_status()["network"]["participants"] == 0), "it said goodbye")
        listening = self.listen(self.two, "--seconds", 8)
        before = self.one.counts()["tx"]
        self.assertEqual(listening.finish("sample"), [])
        after = self.one.counts()["tx"]
        # The kernel's own packets: which multicast groups it is in, and who has an address.
        self.assertLess(after["packets"] - before["packets"], 12)
        self.assertLess(after["bytes"] - before["bytes"], 1200)
        self.assertEqual(world.bridge_status()["network"]["participants"], 0)

    def test_a_cut_cable_is_named_within_a_second_and_messages_come_back(self):
        world = self.bridge()
        topic = ("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        with Programs(FOLDER, domain=0, prefix=self.two.prefix).start_listening("--seconds", 60, *topic) as listening:
            self.assertTrue(wait_for(lambda: len(listening.events("sample")) > 1, 20))
            self.one.set_link(False)
            cut = time.monotonic()
            named = lambda: any("cable" in problem for problem in world.bridge_status()["problems"])
            self.assertTrue(wait_for(named, 5), world.log("bridge"))
            named_after = time.monotonic() - cut
            time.sleep(3)
            before = len(listening.events("sample"))
            self.one.set_link(True)
            plugged = time.monotonic()
            self.assertTrue(wait_for(lambda: len(listening.events("sample")) > before, 20))
            back_after = time.monotonic() - plugged
            self.assertTrue(wait_for(lambda: not named(), 5))
        print(f"named after {named_after:.2f} s, a message {back_after:.2f} s after the cable", file=sys.stderr)
        self.assertLess(named_after, 1.5)
        self.assertLess(back_after, 3)


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    unittest.main()
