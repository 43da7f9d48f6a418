#!/usr/bin/env python3
"""octoskin's view over real sockets: accepted clients, what they get, and what no client can do to it.

usage: view_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import json
import os
import pathlib
import resource
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest

from view_world import ViewWorld, wait_for
from web_socket import BINARY, TEXT, Refused, WebSocket, frame, headers

# Headers of clients as they are: programs in a browser name where their page is from, Electron's pages are files, and
# programs without a page name nothing.
FOXGLOVE_WEB = {"origin": "https://app.foxglove.dev"}
ELECTRON = {"origin": "file://", "subprotocol": "foxglove.sdk.v1, foxglove.websocket.v1"}
PLOTJUGGLER = {"origin": None, "subprotocol": "foxglove.websocket.v1"}
MAP, LINK, ROBOT = "/octoskin/view/map", "/octoskin/view/link", "/octoskin/view/robot"


class Shared(unittest.TestCase):
    """One daemon and one view for all cases of a class."""
    options = {}

    @classmethod
    def setUpClass(cls):
        cls.world = cls.enterClassContext(ViewWorld(FOLDER, **cls.options))

    def connect(self, **handshake):
        connected = WebSocket(self.world.port, **handshake)
        self.addCleanup(connected.close)
        return connected

    def status_of(self, **handshake):
        try:
            with WebSocket(self.world.port, **handshake) as connected:
                return connected.status
        except Refused as refused:
            return refused.status

    def refused(self):
        """The counters of refused connections, as a new client gets them."""
        with WebSocket(self.world.port) as connected:
            notice = connected.until(lambda one: isinstance(one, dict) and one.get("id") == "octoskin.refused")
        return dict((name, int(count)) for name, count in
                    (pair.split(" ") for pair in notice["message"].split(": ")[1].split(", ")))


class Handshakes(Shared):
    options = {"view_options": ["--allow-origin", "https://app.foxglove.dev", "--allow-origin", "file://"]}

    def test_each_client_gets_a_subprotocol_that_it_offered(self):
        for name, handshake, expected in [
                ("Foxglove in a browser", {**FOXGLOVE_WEB, "subprotocol": "foxglove.sdk.v1"}, "foxglove.sdk.v1"),
                ("Foxglove's and Lichtblick's programs", ELECTRON, "foxglove.sdk.v1"),
                ("PlotJuggler", PLOTJUGGLER, "foxglove.websocket.v1"),
                ("the page", {"origin": f"http://127.0.0.1:{self.world.port}"}, "foxglove.sdk.v1"),
                ("the page at localhost", {"origin": f"http://localhost:{self.world.port}",
                                           "host": f"localhost:{self.world.port}"}, "foxglove.sdk.v1")]:
            with self.subTest(name):
                connected = self.connect(**handshake)
                self.assertEqual(connected.subprotocol, expected)
                info = connected.receive()
                self.assertEqual((info["op"], info["capabilities"], info["metadata"]["mode"]),
                                 ("serverInfo", ["services", "assets"], "live"))
                connected.close()

    def test_foreign_origins_are_refused_and_the_remedy_is_named(self):
        for origin in ("null", "http://evil.example", "https://app.foxglove.dev.evil.example",
                       f"https://localhost:{self.world.port}", "http://localhost:3000"):
            self.assertEqual(self.status_of(origin=origin), 403, origin)
        self.assertTrue(wait_for(lambda: "--allow-origin http://evil.example" in self.world.log("view")))

    def test_foreign_hosts_are_refused_for_pages_and_clients(self):
        own, other = self.world.port, self.world.port + 1
        for host in ("evil.example", f"evil.example:{own}", "localhost", f"localhost:{other}"):
            self.assertEqual(self.status_of(host=host), 403, host)
            with socket.create_connection(("127.0.0.1", self.world.port), 10) as page:
                page.sendall(f"GET / HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
                self.assertIn(b" 403 ", page.makefile("rb").readline())

    def test_other_subprotocols_are_refused(self):
        for subprotocol in (None, "", "chat", "foxglove.websocket.v2"):
            self.assertEqual(self.status_of(subprotocol=subprotocol), 400, subprotocol)

    def test_a_further_client_than_there_are_places_is_refused(self):
        connected = [self.connect() for _ in range(16)]
        self.assertEqual(self.status_of(), 503)
        connected.pop().close()
        self.assertTrue(wait_for(lambda: self.status_of() == 101))
        for one in connected:
            one.close()


class Content(Shared):
    def test_foxgloves_own_client_reads_every_topic_and_calls_services(self):
        npm = pathlib.Path(os.environ.get("OCTOSKIN_NPM", FOLDER + "/../../npm"))
        if not (npm / "oracles/node_modules/@foxglove/ws-protocol").exists():
            self.skipTest("@foxglove/ws-protocol is not installed")
        topics = {"/planning_scene": "world", "/octoskin/octomap_binary": "data", "/octoskin/octomap_full": "data",
                  "/octoskin/occupied": "width", "/octoskin/occupied_cells_vis_array": "markers",
                  "/octoskin/projected_map": "info", "/tf_static": "transforms", "/tf": "transforms",
                  "/diagnostics": "status", "/octoskin/view/status": "rig", LINK: "connected", ROBOT: "links"}
        for subprotocol in ("foxglove.websocket.v1", "foxglove.sdk.v1"):
            with self.subTest(subprotocol):
                run = subprocess.run(
                    ["node", SOURCE / "tests/view/foxglove_client.js", str(self.world.port), subprotocol, "3",
                     *topics, "--", "/octoskin/query", json.dumps({"path": [[0, -0.785, 0, -2.356, 0, 1.571, 0.785]]}),
                     "/octoskin/query", json.dumps({"path": []})],
                    env={**os.environ, "OCTOSKIN_NPM": str(npm.resolve())}, capture_output=True, text=True, check=True)
                events = [json.loads(line) for line in run.stdout.splitlines()]
                self.assertEqual([one for one in events if one["event"] in ("error", "failure")], [])
                heard = {one["topic"]: one["fields"] for one in events if one["event"] == "message"}
                self.assertEqual(sorted(heard), sorted(topics))
                for topic, field in topics.items():
                    self.assertIn(field, heard[topic], topic)
                self.assertGreater(heard["/octoskin/occupied"]["width"], 500)
                answers = {one["call"]: one["fields"] for one in events if one["event"] == "answer"}
                asked = self.world.ask('query {"path":[[0,-0.785,0,-2.356,0,1.571,0.785]]}')
                self.assertEqual((answers[0]["ok"], answers[0]["state"]), (True, asked["state"]))
                self.assertFalse(answers[1]["ok"])

    def test_the_map_is_the_daemons_brick_by_brick(self):
        with self.connect() as connected:
            connected.subscribe([MAP])
            bricks, complete = {}, False
            while not complete:
                payload = connected.data(1)[2]
                complete = bool(payload[0] & 2)
                bricks.update(bricks_of(payload[9:]))
        self.assertGreater(len(bricks), 50)
        self.assertEqual(bricks, resting_bricks(self.world))

    def test_deltas_and_the_whole_map_of_a_late_client_are_equal(self):
        early = self.connect()
        early.subscribe([MAP])
        seen = {}
        seen.update(bricks_of(early.data(1)[2][9:]))
        self.world.play()
        late = self.connect()
        late.subscribe([MAP])
        whole = resting_bricks(self.world)
        for connected, known in ((early, seen), (late, {})):
            self.assertTrue(wait_for(lambda: known.update(bricks_of(connected.data(1)[2][9:])) or known == whole, 60))

    def test_the_page_has_a_policy_and_says_if_it_is_not_built(self):
        with socket.create_connection(("127.0.0.1", self.world.port), 10) as asked:
            asked.sendall(f"GET /?a=1 HTTP/1.1\r\nHost: 127.0.0.1:{self.world.port}\r\n\r\n".encode())
            answer = asked.makefile("rb").read().decode()
        head = answer.split("\r\n\r\n")[0]
        is_built = (pathlib.Path(FOLDER).parent / "share/octoskin/view/index.html").exists()
        self.assertEqual(head.split()[1], "200" if is_built else "404")
        self.assertIn("Content-Security-Policy: default-src 'self'", head)

    def test_a_port_that_is_taken_is_an_error_with_a_remedy(self):
        second = subprocess.run([FOLDER + "/octoskin-bridge", "--json-errors", "view", "--port", str(self.world.port)],
                                capture_output=True, text=True, timeout=20, check=False)
        self.assertEqual(second.returncode, 69, second.stderr)
        error = json.loads(second.stderr.splitlines()[-1])["error"]
        self.assertEqual(error["code"], "in_use")
        self.assertIn("--port", error["remedy"])

    def test_wrong_options_are_refused(self):
        for options in (["--allow-origin", "null"], ["--allow-origin", "https://a/b"], ["--port", "65536"],
                        ["--host", "0.0.0.0"]):
            ended = subprocess.run([FOLDER + "/octoskin", "view", *options], capture_output=True, timeout=20,
                                   check=False)
            self.assertEqual(ended.returncode, 64, options)


class Hostile(Shared):
    def assert_serves(self):
        with WebSocket(self.world.port) as connected:
            channels = connected.subscribe([LINK])
            self.assertTrue(json.loads(connected.data(1)[2])["connected"])
            return channels

    def test_a_thousand_silent_connections_keep_no_client_out(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        before = self.world.memory_kib()
        silent = []
        for number in range(1000):
            silent.append(socket.create_connection(("127.0.0.1", self.world.port), 10))
            if number % 2:
                silent[-1].sendall(headers(self.world.port).encode()[:50])
        self.assert_serves()
        descriptors = len(os.listdir(f"/proc/{self.world.bridge.pid}/fd"))
        self.assertLess(descriptors, 150)
        self.assertLess(self.world.memory_kib(), before + 8192)
        for one in silent:
            one.settimeout(10)
            try:
                self.assertEqual(one.recv(1), b"")
            except ConnectionResetError:
                pass
            one.close()
        time.sleep(3.5)  # until the next notice
        self.assertGreaterEqual(self.refused()["silent"], 1000)

    def test_malformed_frames_and_messages_are_closed_and_counted(self):
        bad = [frame(TEXT, b"{}", is_masked=False), frame(3, b""), frame(TEXT, b"\xff\xff"), frame(TEXT, b"{"),
               frame(TEXT, b"[" * 100_000), frame(BINARY, b"\x07"), frame(BINARY, b""),
               frame(BINARY, struct.pack("<BIII", 2, 1, 1, 2**32 - 1))]
        for payload in bad:
            with WebSocket(self.world.port) as connected:
                connected.socket.sendall(payload)
                while connected.receive() is not None:
                    pass
        self.assert_serves()
        time.sleep(3.5)
        self.assertGreaterEqual(self.refused()["malformed"], len(bad))

    def test_a_message_of_gigabytes_is_refused_at_its_length(self):
        before = self.world.memory_kib()
        with WebSocket(self.world.port) as connected:
            connected.socket.sendall(frame(BINARY, b"", length=8 << 30))
            while connected.receive() is not None:
                pass
        self.assertLess(self.world.memory_kib(), before + 2048)
        self.assert_serves()

    def test_half_a_frame_keeps_nothing_from_others(self):
        with WebSocket(self.world.port) as connected:
            connected.socket.sendall(frame(TEXT, b"{", length=100))
            self.assert_serves()

    def test_a_client_that_stops_reading_costs_no_memory_and_gets_the_newest_afterwards(self):
        slow = self.connect(receive_buffer=4096, timeout=30)
        slow.subscribe([MAP, "/octoskin/octomap_full", "/octoskin/view/status"])
        time.sleep(1)
        before = self.world.memory_kib()
        for _ in range(3):
            self.world.play()
        time.sleep(4)
        self.assertLess(self.world.memory_kib(), before + 16384)
        asked_ns = time.time_ns()
        while slow.data(3)[1] < asked_ns:  # by then it has what is sent now
            pass
        slow.until(lambda one: isinstance(one, dict) and one.get("id") == "octoskin.dropped")

    def test_calls_without_an_end_are_refused(self):
        with WebSocket(self.world.port) as connected:
            connected.until(lambda one: isinstance(one, dict) and one["op"] == "advertiseServices")
            request = json.dumps({"path": [[0, -0.785, 0, -2.356, 0, 1.571, 0.785]] * 900, "reach_m": 1}).encode()
            for call in range(20):
                connected.send(struct.pack("<BIII", 2, 1, call, 4) + b"json" + request)
            failed = connected.until(lambda one: isinstance(one, dict) and one["op"] == "serviceCallFailure")
            self.assertIn(failed["callId"], range(20))
        self.assert_serves()


class Daemons(unittest.TestCase):
    def test_a_daemon_that_comes_goes_and_comes_back(self):
        with ViewWorld(FOLDER, has_daemon=False) as world:
            with WebSocket(world.port) as connected:
                channels = connected.subscribe([LINK, MAP])
                link = lambda: json.loads(connected.data(1)[2])
                self.assertEqual((link()["connected"], channels[MAP]["schemaName"]), (False, "octoskin.Map"))
                world.has_daemon = True
                world.start_daemon()
                self.assertTrue(wait_for(lambda: link()["connected"]))
                world.play()
                begins = lambda: connected.data(2)[2][0] & 1
                self.assertTrue(wait_for(begins))
                world.stop_daemon()
                self.assertTrue(wait_for(lambda: not link()["connected"]))
                world.start_daemon()
                self.assertTrue(wait_for(lambda: link()["connected"]))
                self.assertTrue(wait_for(begins))

    def test_a_daemon_that_is_stopped_does_not_hang_the_view(self):
        with ViewWorld(FOLDER) as world:
            world.daemon.send_signal(signal.SIGSTOP)
            try:
                with WebSocket(world.port) as connected:
                    connected.until(lambda one: isinstance(one, dict) and one["op"] == "advertiseServices")
                    begun = time.monotonic()
                    connected.send(struct.pack("<BIII", 2, 2, 1, 4) + b'json{"point_m":[0,0,0]}')
                    with WebSocket(world.port) as other:
                        other.channels([MAP])
                    self.assertLess(time.monotonic() - begun, 2)
                    failed = connected.until(lambda one: isinstance(one, dict) and one["op"] == "serviceCallFailure")
                    self.assertEqual(failed["callId"], 1)
                    self.assertLess(time.monotonic() - begun, 6)
            finally:
                world.daemon.send_signal(signal.SIGCONT)

    def test_a_daemon_that_is_stopped_when_the_view_starts_is_connected_when_it_goes_on(self):
        with ViewWorld(FOLDER, is_mapped=False) as world:
            world.bridge.terminate()
            world.bridge.wait(10)
            world.daemon.send_signal(signal.SIGSTOP)
            try:
                (world.path / "view.log").write_text("")
                world.start_bridge()
                with WebSocket(world.port) as connected:
                    connected.subscribe([LINK])
                    link = lambda: json.loads(connected.data(1)[2])
                    self.assertFalse(link()["connected"])
                    self.assertFalse(link()["connected"], "another reason: it does not answer")
                    world.daemon.send_signal(signal.SIGCONT)
                    self.assertTrue(wait_for(lambda: link()["connected"]))
            finally:
                world.daemon.send_signal(signal.SIGCONT)

    def test_it_ends_at_a_signal(self):
        with ViewWorld(FOLDER, has_daemon=False) as world:
            with WebSocket(world.port):
                world.bridge.terminate()
                self.assertEqual(world.bridge.wait(10), 0)


def take_count(payload, at):
    count = shift = 0
    while True:
        byte = payload[at]
        at += 1
        count |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return count, at


def take_layer(payload, at, value_bytes):
    """The 512 values of a brick's layer, as bytes, or None if nothing is known; and where the next layer begins."""
    form, at = payload[at], at + 1
    if form == 0:
        return None, at
    if form == 1:
        return payload[at:at + value_bytes] * 512, at + value_bytes
    values = b""
    while len(values) < 512 * value_bytes:
        length, at = payload[at], at + 1
        lone = length + 1 if length < 128 else 1
        alike = 1 if length < 128 else length - 126
        values += payload[at:at + lone * value_bytes] * alike
        at += lone * value_bytes
    return values, at


def bricks_of(payload):
    """Each brick's log-odds and time stamps by its number (docs/reference/watch.md)."""
    bricks, at = {}, 8 + 4 + 1 + 4 + 2
    while at < len(payload):
        number, at = take_count(payload, at)
        log_odds, at = take_layer(payload, at, 4)
        stamps, at = take_layer(payload, at, 2)
        bricks[number] = (log_odds, stamps)
    return bricks


def daemons_bricks(world):
    """All bricks, from the daemon's own `watch`."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as daemon:
        daemon.connect(str(world.path / "control"))
        daemon.sendall(b"watch map\n")
        frames = daemon.makefile("rb")
        frames.readline()
        bricks = {}
        while True:
            size, _, _, flags, _, _, _ = struct.unpack("<IHBBQqQ", frames.read(32))
            bricks.update(bricks_of(frames.read(size)))
            if flags & 2:
                return bricks


def resting_bricks(world):
    """The daemon's bricks once it has taken all that was played."""
    before, now = None, daemons_bricks(world)
    while before != now:
        time.sleep(0.5)
        before, now = now, daemons_bricks(world)
    return now


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    SOURCE = pathlib.Path(__file__).resolve().parents[2]
    unittest.main(verbosity=2)
