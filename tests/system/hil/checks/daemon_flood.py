#!/usr/bin/env python3
"""A bus of 1 Mbit/s, four fifths of it other people's frames: every frame and every reading of ours is taken, and of theirs those
that pass the kernel's filters are counted. 0x03F is nobody's and does not pass; 0x381 is of no type, by our node's number."""
import pathlib
import time

import daemon_bench
from daemon_bench import CAN, RECORDING, claim, expect, frames_of

FRAME_BITS = 111   # 8 bytes, standard identifier, with the gap between frames and without stuffing
BUS_BPS = 1_000_000
FOREIGN_SHARE = 0.83  # 0.07 are ours, and some of the rest goes by while the processor does something else
BURST = 8
COUNTED = 300      # frames that pass the filters
LEAST_SHARE = 0.5  # less is no flood: this machine was too busy to make one


def frames_on_bus():
    return int(pathlib.Path(f"/sys/class/net/{CAN}/statistics/rx_packets").read_text())


class Rate:
    """Frames a second on the bus, since it was made."""

    def __init__(self):
        self.began, self.before = time.monotonic(), frames_on_bus()

    def __call__(self):
        return (frames_on_bus() - self.before) / (time.monotonic() - self.began)


def start_flood(bench):
    """At FOREIGN_SHARE: a burst takes its own time beside the gap, and a first second tells how long."""
    def start(gap_s):
        return bench.start("cangen", CAN, "-g", f"{1e3 * gap_s:.3f}", "-c", str(BURST), "-I", "03F", "-L", "8", "-i")
    wanted_s = BURST * FRAME_BITS / (FOREIGN_SHARE * BUS_BPS)
    flood, rate = start(wanted_s), Rate()
    time.sleep(1)
    own_s = BURST / rate() - wanted_s
    flood.kill()
    return start(max(wanted_s - own_s, 1e-5))


def check(bench):
    ours = len(frames_of(RECORDING / "can.log"))
    readings = sum(frame.startswith("201#") for frame in frames_of(RECORDING / "can.log"))
    daemon = bench.daemon("flooded", "--listen-only")
    daemon.await_start()
    flood = start_flood(bench)
    counted = bench.start("cangen", CAN, "-g", "10", "-n", str(COUNTED), "-I", "381", "-L", "8")
    rate = Rate()
    bench.play(RECORDING / "can.log")
    share = rate() * FRAME_BITS / BUS_BPS
    expect("exit code of cangen", 0, counted.wait(daemon_bench.PATIENCE_S))
    flood.kill()
    daemon.await_frames(ours + COUNTED)

    status = daemon.status()
    expect("frames taken, lost in the kernel, malformed", (ours + COUNTED, 0, 0),
           tuple(status["can"][key] for key in ("received", "dropped_by_kernel", "malformed")))
    expect("foreign frames", {"unknown_type": COUNTED}, status["account"]["CAN frames"]["rejected"])
    expect("readings taken", readings, status["account"]["readings"]["in"])
    expect("readings lost", [0] * 4, [sensor["lost"] for sensor in status["nodes"][0]["sensors"]])
    claim(status["account"]["readings"]["used"] > 0, f"readings used: {status['account']['readings']}")
    daemon.stop()
    claim(share >= LEAST_SHARE, f"a flood: {share:.0%} of the bus")
    print(f"{share:.0%} of the bus busy; {readings} readings taken, {status['account']['readings']['used']} used, none lost")


daemon_bench.run(check)
