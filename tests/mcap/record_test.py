#!/usr/bin/env python3
"""`octoskin record --mcap` beside a daemon: record_test.py FOLDER_OF_THE_PROGRAMS"""
import json
import pathlib
import shutil
import socket
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "ros"))
from bridge_world import World  # noqa: E402
from programs import wait_for  # noqa: E402

PROGRAMS = pathlib.Path(sys.argv.pop(1)).resolve()
MAGIC = b"\x89MCAP0\r\n"


class Daemon(World):
    """Without a bridge; joint states come through its socket."""

    def __init__(self):
        super().__init__(PROGRAMS, is_mapped=False)
        self.is_over = False

    def start_bridge(self):
        assert (self.path / "joints").exists()
        self.sender = threading.Thread(target=self.send_joints)
        self.sender.start()
        # The first samples are before the second exchange of SYNC.
        assert wait_for(lambda: self.status()["inputs"]["joint samples"]["used"] > 10), self.log("daemon")

    def send_joints(self):
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            while not self.is_over:
                sender.sendto(f"{time.monotonic():.6f} 0 -0.5 0 -2 0 2 0.5".encode(), str(self.path / "joints"))
                time.sleep(0.01)

    def __exit__(self, *_):
        self.is_over = True
        self.sender.join()
        super().__exit__()


class RecordMcap(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = cls.enterClassContext(Daemon())

    def record(self, folder, *words, program=PROGRAMS / "octoskin"):
        done = subprocess.run(
            [program, "--json-errors", "record", self.daemon.path / folder, "--seconds", "1.5", "--mcap",
             "--socket", self.daemon.path / "control", *words], capture_output=True, text=True, check=False)
        error = json.loads(done.stderr.splitlines()[-1])["error"]["code"] if done.returncode else None
        return done.returncode, error, done.stdout

    def test_makes_a_file_beside_the_recording(self):
        code, error, out = self.record("made")
        self.assertEqual((code, error), (0, None), out)
        self.assertTrue((self.daemon.path / "made/meta.yaml").exists())
        file = (self.daemon.path / "made.mcap").read_bytes()
        self.assertTrue(file.startswith(MAGIC) and file.endswith(MAGIC))
        counts = {line.split()[0]: int(line.split()[1]) for line in out.splitlines() if line.startswith("/")
                  and not line.startswith(str(self.daemon.path))}
        self.assertEqual(counts["/robot_description"], 1)
        self.assertGreater(counts["/joint_states"], 100)

    def test_records_nothing_if_the_file_exists(self):
        (self.daemon.path / "there.mcap").write_text("precious")
        self.assertEqual(self.record("there")[:2], (73, "already_exists"))
        self.assertEqual((self.daemon.path / "there.mcap").read_text(), "precious")
        self.assertFalse((self.daemon.path / "there").exists())

    def test_records_nothing_without_the_program_that_exports(self):
        alone = self.daemon.path / "alone"
        alone.mkdir()
        shutil.copy(PROGRAMS / "octoskin", alone)
        self.assertEqual(self.record("nothing", program=alone / "octoskin")[:2], (69, "no_program"))
        self.assertFalse((self.daemon.path / "nothing").exists())


if __name__ == "__main__":
    unittest.main()
