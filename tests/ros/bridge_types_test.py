#!/usr/bin/env python3
"""The messages of octoskin's bridge have the fields of the public types; each mistake in a field is noticed.

usage: bridge_types_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import copy
import pathlib
import sys
import unittest

import type_hashes

MESSAGES = pathlib.Path(__file__).resolve().parents[2] / "host/bridge/messages"
sys.path.insert(0, str(MESSAGES))
import make_messages  # noqa: E402


class Types(unittest.TestCase):
    def setUp(self):
        self.ours = make_messages.read(MESSAGES / "messages.txt")
        self.public = type_hashes.read_types()

    def is_same(self, messages, name):
        return make_messages.type_hash(messages[name], messages) == type_hashes.type_hash(self.public, name)

    def test_every_message_has_the_public_fields(self):
        self.assertGreater(len(self.ours), 50)
        for name in self.ours:
            with self.subTest(name):
                self.assertTrue(self.is_same(self.ours, name))

    def mutants(self, message):
        """Two fields exchanged, a field missing, a field of another type, a list in place of one."""
        for i in range(len(message.fields)):
            mutant = copy.deepcopy(message)
            del mutant.fields[i]
            yield mutant
            mutant = copy.deepcopy(message)
            mutant.fields[i].base = "int16" if message.fields[i].base != "int16" else "int32"
            yield mutant
            mutant = copy.deepcopy(message)
            mutant.fields[i].length = "" if message.fields[i].length else "[]"
            yield mutant
            if i > 0:
                mutant = copy.deepcopy(message)
                mutant.fields[i - 1], mutant.fields[i] = mutant.fields[i], mutant.fields[i - 1]
                yield mutant

    def test_every_mutant_of_a_message_is_noticed(self):
        count = 0
        for name, message in self.ours.items():
            for mutant in self.mutants(message):
                count += 1
                self.assertFalse(self.is_same({**self.ours, name: mutant}, name), (name, mutant.fields))
        self.assertGreater(count, 500)


if __name__ == "__main__":
    sys.argv.pop(1)
    unittest.main()
