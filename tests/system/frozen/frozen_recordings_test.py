#!/usr/bin/env python3
"""Replays the recordings of tests/data/frozen and compares every map and every counter with expected.json.

usage: frozen_recordings_test.py --octoskin PROGRAM [--write]

--write makes expected.json anew: only for a change that is meant to change maps or accounts.
Exit code: 0 all are equal, 1 some differ (each is named).
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
RECORDINGS = HERE.parent.parent / "data" / "frozen"
EXPECTED = HERE / "expected.json"
ROW = re.compile(r"^(\S[\w ]*?) +(\d+) in = (\d+) used \+ (\d+) rejected$")
COUNTER = re.compile(r"^  (\w+) +(\d+)$")
MAP_FILE = re.compile(r"^ *((?:depth|proximity|fused)\.(?:ot|bt|ply)): (0x[0-9a-f]{8})$")


def account_of(text):
    """The tables that a replay prints, as {unit: {counter: number}}."""
    tables, unit = {}, None
    for line in text.splitlines():
        if row := ROW.match(line):
            unit = tables.setdefault(row[1], {"in": int(row[2]), "used": int(row[3]), "rejected": int(row[4])})
        elif unit is not None and (counter := COUNTER.match(line)):
            unit[counter[1]] = int(counter[2])
        else:
            unit = None
    return tables


def replay(program, recording, configuration):
    """Exit code, checksum of each map file, and account of one replay."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "replay", str(recording), "--out", folder + "/maps"]
        if configuration:
            command += ["--configuration", configuration]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        described = Path(folder, "maps", "maps.yaml")
        lines = described.read_text().splitlines() if described.exists() else []
        maps = dict(found.groups() for found in map(MAP_FILE.match, lines) if found)
        return {"exit_code": done.returncode, "maps": maps, "account": account_of(done.stdout)}


def replays():
    """(name, recording, configuration) of all."""
    for recording in sorted(path for path in RECORDINGS.iterdir() if path.is_dir()):
        if (recording / "order.log").exists():
            yield recording.name, recording, None
            continue
        for configuration in ("fast", "robust"):
            yield f"{recording.name} {configuration}", recording, configuration
        if recording.name.startswith("moving"):
            yield f"{recording.name} aged", recording, str(RECORDINGS / "aged.yaml")
        if recording.name == "rays":
            yield f"{recording.name} paper", recording, "paper"


def differences(expected, actual, path=""):
    """One line for each number that differs."""
    if isinstance(expected, dict) and isinstance(actual, dict):
        for key in sorted(expected.keys() | actual.keys()):
            yield from differences(expected.get(key), actual.get(key), f"{path}/{key}")
    elif expected != actual:
        yield f"{path}: expected {expected}, got {actual}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--octoskin", required=True)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    actual = {name: replay(arguments.octoskin, recording, configuration)
              for name, recording, configuration in replays()}
    empty = [name for name, result in actual.items() if not result["maps"] or not result["account"]]
    if empty:
        print(f"no map or no account: {', '.join(empty)}")
        return 1
    if arguments.write:
        EXPECTED.write_text(json.dumps(actual, indent=1, sort_keys=True) + "\n")
        return 0
    found = list(differences(json.loads(EXPECTED.read_text()), actual))
    print("\n".join(found))
    maps = sum(len(result["maps"]) for result in actual.values())
    print(f"{len(actual)} replays, {maps} maps, {len(found)} differences")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
