#!/usr/bin/env python3
"""Bundles the page where no network can be reached, and compares it with the one that is served.

usage: bundle_test.py NODE SOURCES MODULES FOLDER_OF_THE_PAGE
"""
import filecmp
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

NODE, (SOURCES, MODULES, SERVED) = sys.argv[1], (pathlib.Path(argument) for argument in sys.argv[2:5])
FILES = ["index.html", "licences.txt", "page.css", "page.js", "report_view.js", "worker.js"]
# Where the system forbids namespaces, the comparison alone remains.
IS_ALLOWED = subprocess.run(["unshare", "--map-root-user", "--net", "true"], capture_output=True).returncode == 0
WITHOUT_NETWORK = ["unshare", "--map-root-user", "--net"] if IS_ALLOWED else []


class Bundle(unittest.TestCase):
    def test_is_made_of_files_alone_and_always_the_same(self):
        with tempfile.TemporaryDirectory() as made:
            subprocess.run([*WITHOUT_NETWORK, NODE, SOURCES / "host/bridge/page/build.mjs", MODULES, made,
                            SOURCES / "docs/counters.md"], check=True)
            self.assertEqual(sorted(os.listdir(made)), FILES)
            self.assertEqual(filecmp.cmpfiles(made, SERVED, FILES, shallow=False), (FILES, [], []))

    def test_has_locks_with_exact_versions_hashes_and_no_host(self):
        for folder in ("host/bridge/page", "tests/oracles"):
            text = (SOURCES / folder / "package-lock.json").read_text()
            self.assertNotIn("://", text, folder)
            wanted = json.loads((SOURCES / folder / "package.json").read_text())
            locked = json.loads(text)["packages"]
            for name, version in {**wanted["dependencies"], **wanted.get("devDependencies", {})}.items():
                self.assertEqual(locked[f"node_modules/{name}"]["version"], version)
            for place, package in locked.items():
                self.assertTrue(place == "" or package["integrity"].startswith("sha512-"), place)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
