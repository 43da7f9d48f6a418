#!/usr/bin/env python3
"""octoskin view RECORDING: the map at its end, any time of it, and the same answers as the commands give.

usage: recording_test.py FOLDER_OF_PROGRAMS RECORDING [unittest's arguments]
"""
import itertools
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from view_world import wait_for
from web_socket import WebSocket

LINK, STATUS, MAP = "/octoskin/view/link", "/octoskin/view/status", "/octoskin/view/map"
AT_REST = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]


class RecordedView:
    """A running view of the recording."""

    def __init__(self):
        self.process = subprocess.Popen([FOLDER / "octoskin", "view", RECORDING, "--port", "0"], stderr=subprocess.PIPE,
                                        text=True)
        for line in self.process.stderr:
            if found := re.search(r"http://127\.0\.0\.1:(\d+)/", line):
                self.port = int(found[1])
                return
        raise RuntimeError("the view does not start")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.communicate(timeout=20)


class Client(WebSocket):
    """With the services by name."""

    def __init__(self, port):
        super().__init__(port, timeout=60)
        self.port = port
        advertised = self.until(lambda one: isinstance(one, dict) and one["op"] == "advertiseServices")
        self.services = {service["name"]: service["id"] for service in advertised["services"]}
        self.calls = 0

    def begin(self, service, request):
        self.calls += 1
        self.send(struct.pack("<BIII", 2, self.services[service], self.calls, 4) + b"json" +
                  json.dumps(request).encode())
        return self.calls

    def reply_to(self, call):
        """The JSON of an answer, or the sentence of a failure."""
        def is_it(message):
            if isinstance(message, dict):
                return message["op"] == "serviceCallFailure" and message["callId"] == call
            return message[0] == 3 and struct.unpack_from("<I", message, 5)[0] == call
        message = self.until(is_it, 100000)
        return message["message"] if isinstance(message, dict) else json.loads(message[17:])

    def call(self, service, request):
        return self.reply_to(self.begin(service, request))

    def newest(self, topic):
        """The next message of a topic of JSON, with a connection of its own."""
        with WebSocket(self.port) as one:
            one.subscribe([topic])
            return json.loads(one.data(1)[2])


class View(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.view = cls.enterClassContext(RecordedView())
        cls.client = cls.enterClassContext(Client(cls.view.port))

    def now_s(self):
        return self.client.newest(LINK)["now_s"]

    def play(self, at_s, speed):
        self.assertEqual(self.client.call("/octoskin/play", {"at_s": at_s, "speed": speed}), {"ok": True})

    def an_occupied_point(self):
        for x, y, z in itertools.product(*[[low + 0.04 * i for i in range(25)] for low in (0.3, -0.5, 0.0)]):
            if self.client.call("/octoskin/voxel", {"point_m": [x, y, z]})["state"] == "occupied":
                return [x, y, z]
        raise AssertionError("nothing is occupied")

    def go_to_end(self):
        end_s = self.client.newest(LINK)["end_s"]
        self.play(end_s, 1)
        self.assertTrue(wait_for(lambda: self.now_s() > end_s - 0.2, 60))
        time.sleep(1)

    def test_at_its_end_the_map_is_that_of_a_replay(self):
        with tempfile.TemporaryDirectory() as folder:
            printed = subprocess.run([FOLDER / "octoskin", "replay", RECORDING, "--out", f"{folder}/maps"], check=True,
                                     capture_output=True, text=True).stdout
        known = int(re.search(r"fused\.ot: (\d+) known voxels", printed)[1])
        self.go_to_end()
        self.assertTrue(wait_for(lambda: self.client.newest(STATUS)["map"]["known_voxels"] == known))
        link = self.client.newest(LINK)
        self.assertEqual((link["mode"], link["connected"], link["begin_s"]), ("recording", True, 0))

    def test_it_pauses_and_goes_to_any_time(self):
        self.play(2.5, 0)
        self.assertTrue(wait_for(lambda: 2.4 < self.now_s() < 2.7))
        paused_s = self.now_s()
        time.sleep(1)
        self.assertEqual(self.now_s(), paused_s)
        self.play(None, 1)
        self.assertTrue(wait_for(lambda: self.now_s() > paused_s + 0.5))
        self.play(0, 0)  # the first usable reading comes after the second SYNC
        self.assertTrue(wait_for(lambda: 0 < self.now_s() < 2))
        self.assertTrue(wait_for(lambda: self.client.newest(STATUS)["map"]["known_voxels"] == 0))
        self.assertEqual(self.client.newest(LINK)["speed"], 0)

    def test_a_map_that_begins_anew_is_whole(self):
        with WebSocket(self.view.port, timeout=60) as reader:
            reader.subscribe([MAP])
            self.go_to_end()
            self.play(0.2, 4)
            while not reader.data(1)[2][0] & 2:  # complete
                pass
            self.go_to_end()

    def test_answers_are_those_of_the_commands(self):
        self.go_to_end()
        point = self.an_occupied_point()
        explained = self.client.call("/octoskin/explain", {"point_m": point})
        printed = subprocess.run([FOLDER / "octoskin", "explain", *map(str, point), "--recording", RECORDING, "--json"],
                                 check=True, capture_output=True, text=True).stdout
        self.assertEqual(explained, json.loads(printed))
        voxel = self.client.call("/octoskin/voxel", {"point_m": point})
        self.assertEqual((voxel["ok"], voxel["state"], explained["occupancy"]), (True, "occupied", "occupied"))
        self.assertAlmostEqual(voxel["log_odds"], explained["log_odds"], 5)
        asked = self.client.call("/octoskin/query", {"path": [AT_REST], "own_space_m": 0.1})
        self.assertEqual((asked["ok"], asked["postures"]), (True, 1))
        self.assertIn(asked["state"], ("free", "stale", "unknown", "occupied"))

    def test_requests_that_are_none_are_refused(self):
        for request in ({}, {"at_s": None}, {"at_s": -1, "speed": 1}, {"at_s": 1, "speed": -1}, {"speed": "1"},
                        {"at_s": 1e300, "speed": 1}, {"at_s": None, "speed": 1e9}, {"at_s": None, "speed": 1e-300}):
            self.assertIsInstance(self.client.call("/octoskin/play", request), str, request)
        for request in ({}, {"point_m": [1, 2]}, {"point_m": [1, 2, None]}, {"point_m": "1,2,3"}):
            self.assertIsInstance(self.client.call("/octoskin/explain", request), str, request)
        self.assertEqual(self.client.call("/octoskin/explain", {"point_m": [1e9, 0, 0]})["ok"], False)
        self.assertEqual(self.client.call("/octoskin/query", {"path": 1})["error"]["code"], "wrong_type")

    def test_questions_of_a_client_that_left_keep_no_other_one_waiting(self):
        self.go_to_end()
        for _ in range(2):
            with Client(self.view.port) as left:
                for _ in range(4):
                    left.begin("/octoskin/explain", {"point_m": [0.4, 0, 0.2]})
                left.call("/octoskin/play", {})  # it was read
        begun = time.monotonic()
        self.assertTrue(wait_for(lambda: isinstance(self.client.call("/octoskin/query", {"path": [AT_REST]}), dict), 10))
        self.assertLess(time.monotonic() - begun, 5)

    def test_what_is_no_recording_ends_with_a_code(self):
        for path, code in ((f"{RECORDING}/none", 66), (str(pathlib.Path(RECORDING).parent), 65)):
            ended = subprocess.run([FOLDER / "octoskin", "view", path, "--port", "0"], capture_output=True, timeout=30)
            self.assertIn(ended.returncode, (code, 66), ended.stderr)


if __name__ == "__main__":
    FOLDER = pathlib.Path(sys.argv[1])
    RECORDING = sys.argv[2]
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
