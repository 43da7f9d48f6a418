#!/usr/bin/env python3
"""Two machines of namespaces.py: what passes between them passes through the cable, and nothing else is shared.

usage: namespaces_test.py FOLDER_OF_PROGRAMS [unittest's arguments]      skipped where namespaces are not allowed
"""
import json
import pathlib
import subprocess
import sys
import unittest

import namespaces
from programs import Programs, wait_for

JOINTS = "sensor_msgs/JointState"


def joints(position, **more):
    return {"topic": "/joint_states", "type": JOINTS, "fields": {"name": ["a"], "position": [position]}, **more}


class Machines(unittest.TestCase):
    def setUp(self):
        try:
            machines = namespaces.TwoMachines()
            self.one, self.two = self.enterContext(machines)
        except RuntimeError as error:
            self.skipTest(str(error))

    def programs(self, machine):
        # A domain of their own is not needed: no other program is in these networks.
        return Programs(FOLDER, domain=0, prefix=machine.prefix)

    def packets(self):
        return self.one.counts()["tx"]["packets"] + self.two.counts()["tx"]["packets"]

    def test_reach_each_other_only(self):
        self.one.run("sh", "-c", "test \"$(hostname)\" = one")
        self.assertEqual(self.two.run("sh", "-c", "ls /dev/shm"), "")
        self.one.run("touch", "/dev/shm/octoskin_one")
        self.assertEqual(self.two.run("sh", "-c", "ls /dev/shm"), "")
        self.assertFalse(pathlib.Path("/dev/shm/octoskin_one").exists())
        with self.assertRaises(subprocess.CalledProcessError):
            self.one.run("ip", "route", "get", "192.0.2.1")

    def test_unconfigured_programs_hear_each_other(self):
        with self.programs(self.two).start_listening("--seconds", 20, "--count", 20, "/joint_states",
                                                     JOINTS) as listening:
            before = self.packets()
            said = self.programs(self.one).say([joints(number) for number in range(20)], "--rate", 50)
            self.assertEqual(said.returncode, 0, said.stderr)
            heard = listening.finish("sample")
        self.assertEqual([event["fields"]["position"][0] for event in heard], list(range(20)))
        self.assertGreater(self.packets() - before, 20)

    def test_a_listener_on_the_same_machine_needs_no_packet_for_a_sample(self):
        with self.programs(self.one).start_listening("--seconds", 20, "--count", 200, "--depth", 200, "/joint_states",
                                                     JOINTS) as listening:
            self.programs(self.one).say([joints(number) for number in range(200)], "--rate", 500)
            self.assertEqual(len(listening.finish("sample")), 200)
        self.assertLess(self.packets(), 200)

    def test_a_pulled_cable_holds_samples_up_until_it_is_plugged(self):
        with self.programs(self.two).start_listening("--seconds", 40, "--count", 2, "--depth", 10, "/joint_states",
                                                     JOINTS) as listening, \
                self.programs(self.one).start_saying([joints(1), joints(2, at_s=3)], "--until-read"):
            self.assertTrue(wait_for(lambda: len(listening.events("sample")) == 1, 20))
            self.one.set_link(False)
            self.assertFalse(wait_for(lambda: len(listening.events("sample")) == 2, 5))
            self.one.set_link(True)
            self.assertEqual(len(listening.finish("sample")), 2)


class CommandLine(unittest.TestCase):
    def run_in_both(self, one, two):
        ended = subprocess.run([sys.executable, "-B", namespaces.__file__, one, two], capture_output=True, text=True,
                               check=False)
        if "no namespaces" in ended.stderr:
            self.skipTest(ended.stderr)
        return ended

    def test_runs_a_command_in_each_and_counts_packets(self):
        ended = self.run_in_both("hostname", "sleep 0.2; hostname")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        one, two, counts = ended.stdout.splitlines()
        self.assertEqual((one, two), ("one", "two"))
        self.assertGreaterEqual(json.loads(counts)["two"]["rx"]["packets"], 0)

    def test_fails_if_one_of_them_fails(self):
        self.assertEqual(self.run_in_both("exit 3", "true").returncode, 1)
        self.assertEqual(self.run_in_both("true", "exit 3").returncode, 1)


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    unittest.main()
