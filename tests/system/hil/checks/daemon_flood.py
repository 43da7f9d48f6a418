#!/usr/bin/env python3
"""A bus of 1 Mbit/s full of other people's shortest frames, and ours among them: every frame and every reading of ours is taken, and
of theirs those that pass the kernel's filters are counted. 0x03F is nobody's and does not pass; 0x381 is of no type, by our node's
number. What flood the machine makes is printed, in frames a second; an emulated processor does not make a full one beside its other work."""
import pathlib
import time

import daemon_bench
from daemon_bench import CAN, RECORDING, claim, expect, frames_of

FULL_PER_S = 21_276   # frames of 47 bits back to back: no data, standard identifier, the gap between frames, no stuff bits
TRIED_PER_S = 1.1 * FULL_PER_S  # some of it goes by while the processor does something else
EMULATED_PER_S = 4_000  # 19,000 to 21,400 were seen beside one other program, 8,600 where six wanted the two processors
LEAST_PER_S = EMULATED_PER_S if daemon_bench.IS_EMULATED else FULL_PER_S
BURST = 32
COUNTED = 300         # frames that pass the filters


def frames_on_bus():
    return int(pathlib.Path(f"/sys/class/net/{CAN}/statistics/rx_packets").read_text())


class Rate:
    """Frames a second on the bus, since it was made."""

    def __init__(self):
        self.began, self.before = time.monotonic(), frames_on_bus()

    def __call__(self, without=0):
        return (frames_on_bus() - self.before - without) / (time.monotonic() - self.began)


def start_flood(bench):
    """Of TRIED_PER_S, if the processor can: a burst takes its own time beside the gap, and a first second tells how long."""
    def start(gap_s):
        return bench.start("cangen", CAN, "-g", f"{1e3 * gap_s:.3f}", "-c", str(BURST), "-I", "03F", "-L", "0", "-i")
    wanted_s = BURST / TRIED_PER_S
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
    foreign_per_s = rate(without=ours)
    expect("exit code of cangen", 0, counted.wait(daemon_bench.PATIENCE_S))
    flood.kill()
    daemon.await_frames(ours + COUNTED)

    status = daemon.status()
    expect("frames taken, lost in the kernel, malformed", (ours + COUNTED, 0, 0),
           tuple(status["can"][key] for key in ("received", "dropped_by_kernel", "malformed")))
    rejected = dict(status["inputs"]["CAN frames"]["rejected"])
    expect("foreign frames", COUNTED, rejected.pop("unknown_type"))
    expect("frames of ours that were rejected", {}, rejected)
    expect("readings taken", readings, status["inputs"]["readings"]["in"])
    expect("readings lost", [0] * 4, [sensor["lost"] for sensor in status["nodes"][0]["sensors"]])
    claim(status["inputs"]["readings"]["used"] > 0, f"readings used: {status['inputs']['readings']}")
    daemon.stop()
    claim(foreign_per_s >= LEAST_PER_S, f"foreign frames: {foreign_per_s:.0f}/s, wanted {LEAST_PER_S}")
    print(f"{foreign_per_s:.0f} foreign frames/s, {foreign_per_s / FULL_PER_S:.0%} of a full bus of them; {readings} readings taken, {status['inputs']['readings']['used']} used, none lost")


daemon_bench.run(check)
