"""A recording on a bus, a daemon with a map of some 30,000 occupied voxels, and `octoskin view`, for tests."""
import json
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

import mesh_files

# Links with a mesh as visual; that of link 4 does not exist, that of link 6 has no triangle.
VISUALS = {1: "box.stl", 2: "box.dae", 3: "box.OBJ", 4: "none.stl", 6: "empty.stl"}
# A slow circle: tests have 20 s while no range comes.
SCENARIO = """extends: {}/hw/worlds/experiment.scenario.yaml
motion: {{circle: {{ticks_per_revolution: 750}}}}
"""
SOURCE = pathlib.Path(__file__).resolve().parents[3]
MAPPING = "base: denoised\nmap: {resolution_m: 0.018}\n"
RESOLUTION_M = 0.018
ORIGIN_KEY = 32768


class World:
    """`with World(programs) as world:`; then `play` once, which takes as long as the recording."""

    def __init__(self, programs, prefix=()):
        self.bin, self.prefix = pathlib.Path(programs), list(prefix)
        self.scratch = tempfile.TemporaryDirectory(prefix="octoskin-view-")
        self.path = pathlib.Path(self.scratch.name)
        self.daemon = self.view = self.bus = self.player = None
        self.files = []

    def __enter__(self):
        try:
            self.make_recording()
            self.start_daemon()
            self.start_view()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        if self.player is not None:
            self.player.terminate()
            self.player.wait(20)
            self.player.stdin.close()
        for process in (self.view, self.daemon):
            if process is not None and process.poll() is None:
                process.terminate()
                process.wait(20)
        if self.bus is not None:
            self.bus.close()
        for file in self.files:
            file.close()
        self.scratch.cleanup()

    def run(self, *command):
        subprocess.run([str(word) for word in command], check=True, capture_output=True)

    def make_recording(self):
        (self.path / "mapping.yaml").write_text(MAPPING)
        (self.path / "scenario.yaml").write_text(SCENARIO.format(SOURCE))
        self.run(self.bin / "octoskin-lab", "simulate", self.path / "recording", "--scenario",
                 self.path / "scenario.yaml")
        self.run(self.bin / "octoskin", "replay", self.path / "recording", "--fused-only", "--configuration",
                 self.path / "mapping.yaml", "--out", self.path / "replayed")
        self.add_meshes()
        (self.path / "maps").mkdir()
        shutil.copy(self.path / "replayed/fused.ot", self.path / "maps")

    def add_meshes(self):
        (self.path / "meshes").mkdir()
        files = {"box.stl": mesh_files.stl(), "box.dae": mesh_files.dae(), "box.OBJ": mesh_files.obj(),
                 "empty.stl": b"solid empty\nendsolid\n"}
        for name, content in files.items():
            (self.path / "meshes" / name).write_bytes(content)
        robot = self.path / "recording/robot.urdf"
        text = robot.read_text()
        for link, file in VISUALS.items():
            begin = f'<link name="panda_link{link}">'
            assert begin in text, begin
            text = text.replace(begin, begin + mesh_files.visual(file))
        robot.write_text(text)

    def start_daemon(self):
        daemon_end, self.bus = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.daemon = subprocess.Popen(
            [self.bin / "octoskin", "run", "--rig", self.path / "recording/rig.yaml", "--can",
             f"fd:{daemon_end.fileno()}", "--listen-only", "--no-camera", "--maps", self.path / "maps", "--save-every",
             "1", "--configuration", self.path / "mapping.yaml", "--socket", self.path / "control"],
            pass_fds=[daemon_end.fileno()], stderr=self.log_file("daemon"))
        daemon_end.close()
        self.wait_for(lambda: (self.path / "control").exists(), "daemon")

    def start_view(self, port=0):
        """At any free port, or at the one that a page already knows."""
        self.view = subprocess.Popen([*self.prefix, self.bin / "octoskin", "view", "--socket", self.path / "control",
                                      "--port", str(port), "--package-path",
                                      f"meshes_of_test={self.path / 'meshes'}"], stderr=self.log_file("view"))
        self.wait_for(self.url_of_view, "view")
        self.url = self.url_of_view()
        self.port = int(re.search(r":(\d+)", self.url)[1])

    def log_file(self, name):
        """A new file, closed at the end."""
        self.files.append(open(self.path / f"{name}.log", "w"))
        return self.files[-1]

    def url_of_view(self):
        found = re.search(r"http://\S+", (self.path / "view.log").read_text())
        return found and found[0]

    def stop_view(self):
        self.view.terminate()
        self.view.wait(20)

    def wait_for(self, condition, name, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise AssertionError(f"{name}: not within {seconds} s\n" + (self.path / f"{name}.log").read_text())
            time.sleep(0.02)

    def play(self):
        """In the background: play_in_parts.py."""
        program = pathlib.Path(__file__).with_name("play_in_parts.py")
        self.player = subprocess.Popen(
            [sys.executable, "-B", program, self.path / "recording/can.log", str(self.bus.fileno())],
            pass_fds=[self.bus.fileno()], stdin=subprocess.PIPE, stdout=self.log_file("player"))

    def play_again(self):
        self.player.stdin.write(b"again\n")
        self.player.stdin.close()

    @property
    def phase(self):
        """before, playing, pausing, playing again, after."""
        lines = (self.path / "player.log").read_text().splitlines() if self.player else []
        return lines[-1] if lines else "before"

    def wait_for_phase(self, phase, seconds=60):
        self.wait_for(lambda: self.phase == phase, "player", seconds)

    def ask(self, request):
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as asked:
            asked.connect(str(self.path / "control"))
            asked.sendall(request.encode() + b"\n")
            return json.loads(asked.makefile().readline())

    def wait_for_save(self):
        """Until a map that was saved after this call is there."""
        before = self.ask("status")["map"]["saved"]
        self.wait_for(lambda: self.ask("status")["map"]["saved"] > before + 1, "daemon")

    def occupied(self, map_file="maps/fused.bt", resolution_m=RESOLUTION_M):
        """Keys of the occupied voxels in a map, by default the daemon's saved one, as bt2vrml of OctoMap reads it."""
        copied = self.path / "copied.bt"
        shutil.copy(self.path / map_file, copied)
        self.run("bt2vrml", copied)
        return set(boxes((self.path / "copied.bt.wrl").read_text(), resolution_m))


def boxes(vrml, resolution_m):
    """The voxels of the boxes of a VRML file: OctoMap joins equal ones to larger cubes."""
    number = r"(-?[\d.e-]+)"
    for x, y, z, size in re.findall(rf"translation {number} {number} {number}\s+children \[ Shape "
                                    rf"{{ geometry Box {{ size {number}", vrml):
        edge = round(float(size) / resolution_m)
        low = [round((float(centre) - float(size) / 2) / resolution_m) + ORIGIN_KEY for centre in (x, y, z)]
        for i in range(edge):
            for j in range(edge):
                for k in range(edge):
                    yield low[0] + i, low[1] + j, low[2] + k


def surface(occupied):
    """Those with a neighbour that is not occupied: the others have no visible face."""
    steps = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    return {key for key in occupied
            if any((key[0] + x, key[1] + y, key[2] + z) not in occupied for x, y, z in steps)}
