#!/usr/bin/env python3
"""The field lists and their type hashes, compared with hashes that others publish."""
import copy
import pathlib
import unittest

import make_idl
import type_hashes

PUBLISHED = pathlib.Path(__file__).resolve().parent / "published_hashes.txt"


def published():
    rows = [line.split() for line in PUBLISHED.read_text().splitlines() if line and not line.startswith("#")]
    return {name.replace("/msg/", "/"): type_hash for name, type_hash, _ in rows}


def neighbours_swapped(types):
    """(name, types with two neighbouring fields of it swapped), for every pair of neighbours of every type."""
    for name, fields in types.items():
        for first in range(len(fields) - 1):
            mutant = copy.copy(types)
            mutant[name] = fields[:first] + [fields[first + 1], fields[first]] + fields[first + 2:]
            yield name, mutant


class TypeHashes(unittest.TestCase):
    def setUp(self):
        self.types = type_hashes.read_types()

    def test_equal_the_published_ones(self):
        self.assertGreaterEqual(len(published()), 40)
        for name, type_hash in published().items():
            with self.subTest(name):
                self.assertEqual(type_hashes.type_hash(self.types, name), type_hash)

    def test_differ_if_two_fields_change_places(self):
        swaps = 0
        for name, mutant in neighbours_swapped(self.types):
            swaps += 1
            expected = published().get(name) or type_hashes.type_hash(self.types, name)
            self.assertNotEqual(type_hashes.type_hash(mutant, name), expected, name)
        self.assertGreater(swaps, 100)

    def test_of_a_containing_type_differ_if_two_fields_change_places(self):
        scene = "moveit_msgs/PlanningScene"
        expected = type_hashes.type_hash(self.types, scene)
        within = type_hashes.referenced(self.types, scene)
        for name, mutant in neighbours_swapped(self.types):
            if name in within:
                self.assertNotEqual(type_hashes.type_hash(mutant, scene), expected, name)

    def test_differ_for_each_width_of_a_field(self):
        hashes = set()
        for kind in ("uint8", "uint16", "uint8[]", "uint8[4]", "uint8[5]", "uint8[<=4]"):
            hashes.add(type_hashes.type_hash({"a/B": [type_hashes.Field(f"{kind} x")]}, "a/B"))
        self.assertEqual(len(hashes), 6)


class FieldLists(unittest.TestCase):
    def test_refuse_what_is_no_field(self):
        for line in ("float64", "float63 x", "float64 X", "float64[ x", "float64  x"):
            with self.subTest(line), self.assertRaises(ValueError):
                type_hashes.Field(line)


class Idl(unittest.TestCase):
    def test_defines_each_type_after_those_that_it_contains(self):
        types = type_hashes.read_types()
        order = make_idl.in_order(types)
        self.assertEqual(sorted(order), sorted(types))
        for name in order:
            for contained in type_hashes.referenced(types, name):
                self.assertLess(order.index(contained), order.index(name))

    def test_has_the_members_in_the_order_of_the_fields(self):
        text = make_idl.struct("sensor_msgs/Range", type_hashes.read_types()["sensor_msgs/Range"])
        members = [line.split()[-1] for line in text.splitlines() if line.startswith("    ")]
        self.assertEqual(members, ["header_;", "radiation_type_;", "field_of_view_;", "min_range_;", "max_range_;",
                                   "range_;", "variance_;"])


if __name__ == "__main__":
    unittest.main()
