#!/usr/bin/env python3
"""camera_plug_test.py OCTOSKIN OPENNI2-FOLDER: a daemon's camera is unplugged and plugged in again; and one whose only mode of the
rig's size has another rate than the rig is named for that once, and not for its silence between two frames. The folder has the driver of
tests/support/camera_driver: 80 x 60 at 2 Hz, 160 x 120 at 30 Hz."""
import contextlib
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import time

OCTOSKIN, OPENNI2 = sys.argv[1:]
SOURCE = pathlib.Path(__file__).resolve().parents[3]
RIG = (SOURCE / "tests/system/hil/two_linux_boards_fd.yaml").read_text().replace("../../../", f"{SOURCE}/")
MODE = "{width_px: 80, height_px: 60, fx_px: 80, fy_px: 80, cx_px: 40, cy_px: 30, rate_hz: 2,"
assert MODE in RIG
PATIENCE_S = 20
NAMED_S = 3 * 0.5 + 1.0  # three periods at 2 Hz; and the second within which it is to be said
BACK_S = 5.0


class Daemon:
    """On a bus on which nobody is."""

    def __init__(self, scratch, rig_text):
        self.plug, self.said, self.control = scratch / "camera", scratch / "said", scratch / "control"
        self.plug.write_text("1500\n")
        (scratch / "rig.yaml").write_text(rig_text)
        self.bus, its_end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        command = [OCTOSKIN, "run", "--rig", scratch / "rig.yaml", "--can", f"fd:{its_end.fileno()}", "--maps", scratch / "maps",
                   "--socket", self.control]
        with open(self.said, "w", encoding="utf-8") as said, its_end:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=said, stderr=said, pass_fds=[its_end.fileno()],
                                            env={**os.environ, "LD_LIBRARY_PATH": OPENNI2, "OCTOSKIN_TEST_CAMERA": str(self.plug)})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.bus.close()

    def status(self):
        with socket.socket(socket.AF_UNIX) as control:
            control.settimeout(PATIENCE_S)
            control.connect(str(self.control))
            control.sendall(b"status\n")
            return json.loads(control.makefile().readline())

    def wait_until(self, what, is_so):
        """Seconds that it took."""
        began = time.monotonic()
        while time.monotonic() - began < PATIENCE_S:
            with contextlib.suppress(OSError):  # it has not begun yet
                if is_so(self.status()):
                    return time.monotonic() - began
            time.sleep(0.02)
        raise AssertionError(f"{what}: not within {PATIENCE_S} s: {self.said.read_text()}")

    def lines_of_camera(self):
        return [line for line in self.said.read_text().splitlines() if "camera: " in line]


def timed_frames(status):
    return status["cameras"][0]["frames"] - status["cameras"][0]["untimed"]


def unplug_and_plug_in(scratch):
    with Daemon(scratch, RIG) as daemon:
        daemon.wait_until("frames", lambda status: timed_frames(status) >= 2)
        daemon.plug.unlink()
        named_s = daemon.wait_until("its name", lambda status: any(problem.get("on") == "camera" for problem in status["problems"]))
        daemon.wait_until("its end", lambda status: not status["cameras"][0]["open"] and "no camera" in status["cameras"][0]["why"])
        before = timed_frames(daemon.status())
        daemon.plug.write_text("1500\n")
        back_s = daemon.wait_until("frames again", lambda status: timed_frames(status) > before)
        print(f"unplugged: named after {named_s:.2f} s; plugged in: frames with a time after {back_s:.2f} s, at 2 Hz")
        assert named_s <= NAMED_S, named_s
        assert back_s <= BACK_S, back_s


def name_rate_once(scratch, wanted, mode_hz):
    """`wanted`: (width, height, rate) of the rig."""
    width, height, rate_hz = wanted
    mode = MODE.replace("80, height_px: 60", f"{width}, height_px: {height}").replace("rate_hz: 2,", f"rate_hz: {rate_hz},")
    with Daemon(scratch, RIG.replace(MODE, mode)) as daemon:
        daemon.wait_until("frames", lambda status: timed_frames(status) >= 2)
        time.sleep(3)
        rate = f"has {mode_hz} frames a second, the rig {rate_hz}"
        told = [problem for problem in daemon.status()["problems"] if problem["code"] == "camera_rate"]
        assert len(told) == 1 and rate in told[0]["text"], daemon.status()["problems"]
        lines = daemon.lines_of_camera()
        assert sum(rate in line for line in lines) == 1, lines
        assert not any("three periods" in line for line in lines), lines


for check in (unplug_and_plug_in, lambda scratch: name_rate_once(scratch, (80, 60, 30), 2),
              lambda scratch: name_rate_once(scratch, (160, 120, 5), 30)):
    with tempfile.TemporaryDirectory() as folder:
        check(pathlib.Path(folder))
