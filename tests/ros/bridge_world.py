"""A daemon with the map of a recording, and a bridge beside it, for tests."""
import functools
import json
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import time

from programs import DOMAIN, wait_for

SOURCE = pathlib.Path(__file__).resolve().parents[2]
FROZEN = SOURCE / "tests/data/frozen"


@functools.lru_cache
def map_of(programs, recording):
    """The folder with the recording's map, made once: played onto a bus, it takes as long as it took to record."""
    folder = tempfile.TemporaryDirectory(prefix="octoskin-map-")
    subprocess.run([programs / "octoskin", "replay", recording, "--out", folder.name, "--fused-only"],
                   check=True, capture_output=True)
    return folder


class World:
    """`with World(folder) as world:` the daemon has loaded the map of the recording, and its bus is silent.

    `is_mapped=False`: it begins with an empty map, and takes joint states.
    """

    def __init__(self, programs, recording="rays", rig=None, daemon_options=("--no-camera",), bridge_options=(),
                 prefix=(), environment=None, domain=DOMAIN, is_mapped=True):
        self.bin = pathlib.Path(programs)
        self.recording, self.rig = FROZEN / recording, rig or FROZEN / recording / "rig.yaml"
        self.daemon_options, self.bridge_options, self.prefix = list(daemon_options), list(bridge_options), list(prefix)
        self.environment = {**os.environ, "ROS_DOMAIN_ID": str(domain), **(environment or {})}
        self.folder = tempfile.TemporaryDirectory(prefix="octoskin-bridge-")
        self.path = pathlib.Path(self.folder.name)
        self.is_mapped, self.log_files = is_mapped, []
        self.daemon = self.bridge = self.bus = None

    def __enter__(self):
        try:
            if self.is_mapped:
                shutil.copytree(map_of(self.bin, self.recording).name, self.path / "maps")
            self.start_daemon()
            self.start_bridge()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in (self.bridge, self.daemon):
            if process is not None and process.poll() is None:
                process.terminate()
                try:
                    process.wait(10)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
        if self.bus is not None:
            self.bus.close()
        for file in self.log_files:
            file.close()
        self.folder.cleanup()

    def start_daemon(self):
        """A recording has its own SYNC: then the daemon only listens, and else it takes joint states."""
        listens = ["--listen-only"] if self.is_mapped else ["--joints", self.path / "joints"]
        if self.bus is not None:
            self.bus.close()
        daemon_end, self.bus = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.daemon = subprocess.Popen(
            [self.bin / "octoskin", "run", "--rig", self.rig, "--can", f"fd:{daemon_end.fileno()}", *listens,
             "--maps", self.path / "maps", "--socket", self.path / "control", *self.daemon_options],
            pass_fds=[daemon_end.fileno()], stderr=self.log_file("daemon"))
        daemon_end.close()
        assert wait_for(lambda: self.answers("control")), self.log("daemon")

    def play(self):
        """All of the recording, in its own time, then until the map has it."""
        subprocess.run([self.bin / "octoskin", "replay", self.recording, "--onto", f"fd:{self.bus.fileno()}"],
                       pass_fds=[self.bus.fileno()], check=True, capture_output=True)
        time.sleep(0.3)

    def start_bridge(self):
        self.bridge = subprocess.Popen(
            [*self.prefix, self.bin / "octoskin", "bridge", "run", "--socket", self.path / "control", "--joints",
             self.path / "joints", "--status-socket", self.path / "bridge", *self.bridge_options],
            env=self.environment, stderr=self.log_file("bridge"))
        assert wait_for(lambda: self.answers("bridge")), self.log("bridge")
        assert wait_for(lambda: self.bridge_status()["daemon"]["connected"]), self.log("bridge")

    def log_file(self, name):
        self.log_files.append(open(self.path / f"{name}.log", "a"))
        return self.log_files[-1]

    def log(self, name):
        return (self.path / f"{name}.log").read_text()

    def ask(self, request, place="control"):
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as asked:
            asked.connect(str(self.path / place))
            asked.sendall(request.encode() + b"\n")
            return json.loads(asked.makefile().readline())

    def answers(self, place):
        """False also between the making of a socket and its first `listen`."""
        try:
            return bool(self.ask("status", place))
        except (FileNotFoundError, ConnectionRefusedError):
            return False

    def status(self):
        return self.ask("status")

    def bridge_status(self):
        return self.ask("status", "bridge")

    def topic(self, name):
        return next(topic for topic in self.bridge_status()["topics"] if topic["topic"] == name)
