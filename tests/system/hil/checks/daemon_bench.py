"""What the checks of the daemon share: daemons and what they say of themselves, frames played onto the bus, frames heard on it.
The recording that is played is of replayed_board.yaml, made by the build. Nobody else is on the bus."""
import contextlib
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time

import machine_disk

CAN = os.environ["HIL_CAN"]
OCTOSKIN = os.environ["HIL_BIN"] + "/octoskin"
OPENNI2 = os.environ["HIL_BIN"] + "/hil_openni2"  # with the driver of tests/support/camera_driver
RECORDING = pathlib.Path(os.environ["HIL_RECORDING"])
PATIENCE_S = 60  # the emulated processor is slow, and its host may be busy: this long for what takes a second
VENDOR = pathlib.Path("/sys/class/dmi/id/sys_vendor")  # QEMU's own machines are emulated here (machine.py); a board may have none
IS_EMULATED = VENDOR.exists() and VENDOR.read_text().strip() == "QEMU"


class CheckFailed(Exception):
    pass


def limit_s(promised_s, emulated_s):
    """The promise itself, and on an emulated processor `emulated_s` more: each call of this says what that is for."""
    return promised_s + (emulated_s if IS_EMULATED else 0)


def expect(what, wanted, got):
    if wanted != got:
        raise CheckFailed(f"{what}: wanted {wanted!r}, got {got!r}")


def claim(is_true, what):
    if not is_true:
        raise CheckFailed(what)


def wait_until(what, is_so, seconds=PATIENCE_S, period_s=0.05):
    """Seconds that it took. Asks every `period_s`."""
    began = time.monotonic()
    while not is_so():
        claim(time.monotonic() - began < seconds, f"{what}: not within {seconds} s")
        time.sleep(period_s)
    return time.monotonic() - began


def frames_of(log):
    """Frames of a candump log in their order, as `ID#DATA`; it may be being written."""
    return [line.split()[2] for line in pathlib.Path(log).read_text().splitlines(keepends=True) if line.endswith("\n")]


def codes_of(status):
    return [problem["code"] for problem in status["problems"]]


def has_sentence(status, words):
    """The sentence of a problem contains these words."""
    return any(words in problem["text"] for problem in status["problems"])


def is_link_named(status, state, words, subject=""):
    """The first of the problems, as a sentence, says so of the link."""
    told = status["problems"][0]["text"] if status["problems"] else ""
    return status["can"]["state"] == state and told.startswith(f"CAN {state}: {subject}") and words in told


def is_link_up(status):
    return status["can"]["state"] == "up" and "can_link" not in codes_of(status)


class Daemon:
    """`octoskin run` with a folder of its own, which a later one may take over. Its camera, if it shall have one, is plugged in
    by the file `camera`."""

    def __init__(self, folder, *arguments, maps=None, rig=None, camera=None):
        self.folder = folder
        self.socket, self.maps, self.said = folder / "control", maps or folder / "maps", folder / "said"
        folder.mkdir(exist_ok=True)
        robot = [] if rig else ["--robot", RECORDING / "robot.urdf"]
        command = [OCTOSKIN, "run", "--rig", rig or RECORDING / "rig.yaml", *robot, "--can", CAN, "--maps", self.maps,
                   "--socket", self.socket, *([] if camera else ["--no-camera"]), *arguments]
        driver = {"LD_LIBRARY_PATH": f"{OPENNI2}", "OCTOSKIN_TEST_CAMERA": f"{camera}"} if camera else {}
        with open(self.said, "a", encoding="utf-8") as said:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=said, stderr=said, env={**os.environ, **driver})

    def await_start(self):
        """Until it answers."""
        def answers():
            claim(self.process.poll() is None, f"the daemon ended:\n{self.said.read_text()}")
            with contextlib.suppress(OSError):
                return bool(self.status())
            return False
        wait_until("the daemon's start", answers, period_s=0.2)  # more often, the asking takes the start's time away

    def status(self):
        """What `octoskin status --json` shows, without its start, which takes this processor a second."""
        with socket.socket(socket.AF_UNIX) as control:
            control.settimeout(PATIENCE_S)
            control.connect(str(self.socket))
            control.sendall(b"status\n")
            return json.loads(control.makefile().readline())

    def account(self, unit="readings"):
        return self.status()["inputs"][unit]

    def await_status(self, what, is_so, seconds=PATIENCE_S):
        """Seconds that it took, one question's more at most."""
        return wait_until(what, lambda: is_so(self.status()), seconds)

    def await_frames(self, count):
        """Until it has taken so many in."""
        self.await_status(f"{count} frames", lambda status: status["can"]["received"] >= count)

    def stop(self):
        self.process.terminate()
        expect("exit code of the daemon", 0, self.process.wait(PATIENCE_S))

    def kill(self):
        self.process.kill()
        self.process.wait(PATIENCE_S)


class Listener:
    """candump, from when it really listens."""

    def __init__(self, log):
        self.log = log
        with open(log, "wb") as output:
            self.process = subprocess.Popen(["candump", "-L", CAN], stdin=subprocess.DEVNULL, stdout=output)
        listens = f" {CAN} "
        wait_until("candump", lambda: listens in pathlib.Path("/proc/net/can/rcvlist_all").read_text())

    def stop(self):
        """What it heard."""
        self.process.terminate()
        self.process.wait(PATIENCE_S)
        return frames_of(self.log)


class Bench:
    """Everything that a check starts, ended with it."""

    def __init__(self):
        self.ended_with_us = contextlib.ExitStack()
        self.daemons = []
        self.folder = pathlib.Path(self.ended_with_us.enter_context(tempfile.TemporaryDirectory()))

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        for said in sorted({daemon.said for daemon in self.daemons}) if kind else ():
            print(f"-- the end of {said}:", *said.read_text().splitlines()[-15:], sep="\n", flush=True)
        self.ended_with_us.close()

    def folder_on_disk(self):
        """On the machine's disk, not in its memory as `folder` is; of a machine without one, on its host's."""
        place = machine_disk.mounted() or os.environ["HIL_FOLDER"]
        return pathlib.Path(self.ended_with_us.enter_context(tempfile.TemporaryDirectory(dir=place)))

    def end_with_us(self, process):
        self.ended_with_us.callback(process.wait)
        self.ended_with_us.callback(process.kill)
        return process

    def daemon(self, name, *arguments, **places):
        """Started; another one may start meanwhile. `maps` and `rig` may be elsewhere; `camera`: Daemon."""
        daemon = Daemon(self.folder / name, *arguments, **places)
        self.daemons.append(daemon)
        self.end_with_us(daemon.process)
        return daemon

    def without_weakening(self):
        """Arguments of a daemon whose readings make no known voxel unknown: the count of known voxels never falls, so that it shows
        how old a saved map is."""
        configuration = self.folder / "without_weakening.yaml"
        configuration.write_text("base: denoised\nray_end_sigmas: 0\n")
        return "--configuration", configuration

    def listener(self):
        listener = Listener(self.folder / "heard.log")
        self.end_with_us(listener.process)
        return listener

    def start(self, *command):
        return self.end_with_us(subprocess.Popen(command, stdin=subprocess.DEVNULL))

    def start_playing(self, log):
        """As fast as it was recorded, by canplayer, which plays what a recorder wrote of `can0`."""
        return self.start("canplayer", f"{CAN}=can0", "-I", str(log))

    def first_lines(self, log, count):
        begin = self.folder / f"first_{count}.log"
        begin.write_text("".join(log.read_text().splitlines(keepends=True)[:count]))
        return begin

    def play(self, log):
        expect("exit code of canplayer", 0, self.start_playing(log).wait(PATIENCE_S))

    def play_by_ourselves(self, recording):
        expect("exit code of octoskin replay --onto", 0, self.start(OCTOSKIN, "replay", recording, "--onto", CAN).wait(PATIENCE_S))

    @staticmethod
    def lateness(played, heard):
        """Seconds by which some frames of a log came later than others, measured by those that were in time."""
        stamps = ([float(line.split()[0].strip("()")) for line in pathlib.Path(log).read_text().splitlines()] for log in (played, heard))
        behind = [there - here for here, there in zip(*stamps)]
        return max(behind) - min(behind)

    def replay(self, recording, *arguments):
        """What `octoskin replay` prints."""
        done = subprocess.run([OCTOSKIN, "replay", recording, *arguments], capture_output=True, text=True, timeout=PATIENCE_S,
                              check=False)
        expect(f"exit code of octoskin replay ({done.stderr})", 0, done.returncode)
        return done.stdout


def run(check):
    """The check as a program: exit code 0, or 1 and what was not as it must be."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(124))
    try:
        with Bench() as bench:
            check(bench)
    except CheckFailed as failure:
        print(f"FAILED: {failure}")
        sys.exit(1)
