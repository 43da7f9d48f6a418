#!/usr/bin/env python3
"""Sensors and a camera to one map: a Linux node with four sensors, an arm at rest, a camera of OpenNI2, and the daemon whose SYNC
the node follows. The ranges in the status are what the sensors truly see, and their beams are on the map, where the camera's images
of a wall that stands still add nothing any more; a camera that is unplugged, and a node that is stopped, are
named, while the others go on; nobody else sends anything. One node of the rig's two: with both, the
emulated processor has no time left for the daemon."""
import contextlib
import math
import os
import pathlib
import subprocess
import threading
import time

import daemon_bench
from daemon_bench import CAN, OCTOSKIN, claim, expect

RIG = pathlib.Path(__file__).resolve().parent.parent / "two_linux_boards_fd.yaml"
JOINT_NODE = 10
WALL_MM = 1500
CAMERA_NAMED_S = 4.0  # 2 s of silence, and the emulated processor
NAMED_S = 1.5  # 0.35 s without a heartbeat, and the emulated processor
PATIENCE_S = 120  # each node has hundreds of transfers to make, on an emulated processor
TRUE_RANGE_M = {0: 0.250, 1: 0.500}  # as board.sh says; sensor 2's moves, mostly on the arm itself, 3 sees nothing
MOVING_RANGE_M = 1.0  # of sensor 2, at most
RESOLUTION_M = 0.04


def start_node(bench):
    """The first board's."""
    return bench.start(f"{os.environ['HIL_BIN']}/octoskin-node", "--config", f"{os.environ['HIL_BLOCKS']}/first.fd.block", "--can", CAN,
                       "--i2c-lateness-ms", "500", "--i2c", "/dev/i2c-7", "/dev/i2c-8", "--xshut", f"{os.environ['HIL_CHIP']}:0,1,2,3",
                       "--uid", "0102030405060708090a0b0c")


def keep_arm_at_rest(bench):
    """A joint sample each 20 ms from the rig's joint node, until the check ends. It keeps the bus from falling silent, too, which a
    single node's heartbeats on a busy processor do not."""
    joints = bench.end_with_us(subprocess.Popen([OCTOSKIN, "joints", "--can", CAN, "--rig", RIG], stdin=subprocess.PIPE, text=True))

    def feed():
        with contextlib.suppress(OSError):  # it has ended
            while True:
                joints.stdin.write("0 0 0 -1.5 0 1.5 0\n")
                joints.stdin.flush()
                time.sleep(0.02)
    threading.Thread(target=feed, daemon=True).start()


def used(status, unit):
    return status["account"][unit]["used"]


def await_images(daemon, count):
    """So many more of them on the map."""
    before = used(daemon.status(), "depth frames")
    daemon.await_status(f"{count} images on the map", lambda now: used(now, "depth frames") >= before + count, PATIENCE_S)


def expect_beams(added):
    """A beam of length l leads through l / resolution voxels at least, along an axis, and through sqrt(3) times as many and one for
    each axis at most. Of the arm at rest, each sensor's are the same voxels again and again; no two sensors look the same way."""
    at_least = sum(int(range_m / RESOLUTION_M) for range_m in TRUE_RANGE_M.values())
    at_most = sum(math.sqrt(3) * range_m / RESOLUTION_M + 3 for range_m in (*TRUE_RANGE_M.values(), MOVING_RANGE_M))
    claim(at_least <= added <= at_most, f"voxels of the sensors: {added}, wanted {at_least} to {at_most:.0f}")


def unplug_and_plug_in(daemon, plug):
    """The camera, while the node ranges: what that took, in seconds."""
    opened, before = daemon.status()["camera"]["opened"], used(daemon.status(), "readings")
    plug.unlink()
    named_s = daemon.await_status("the camera's name", lambda now: any(text.startswith("camera: ") for text in now["problems"]))
    claim(named_s <= CAMERA_NAMED_S, f"the camera that is gone was named after {named_s:.2f} s")
    daemon.await_status("an end of it", lambda now: not now["camera"]["open"] and "no camera" in now["camera"]["why"])
    daemon.await_status("readings without a camera", lambda now: used(now, "readings") > before, PATIENCE_S)
    gone = used(daemon.status(), "depth frames")
    plug.write_text(f"{WALL_MM}\n")
    back_s = daemon.await_status("the camera's frames again", lambda now: used(now, "depth frames") > gone, PATIENCE_S)
    status = daemon.status()
    claim(status["camera"]["open"] and status["camera"]["opened"] > opened, f"the camera: {status['camera']}")
    claim(not any(text.startswith("camera: ") for text in status["problems"]), f"problems: {status['problems']}")
    return named_s, back_s


def check(bench):
    plug = bench.folder / "camera"
    plug.write_text(f"{WALL_MM}\n")
    daemon = bench.daemon("daemon", rig=RIG, camera=plug)
    daemon.await_start()
    expect("voxels before there is a pose", 0, daemon.status()["map"]["known_voxels"])
    keep_arm_at_rest(bench)
    listener = bench.listener()
    try:
        await_images(daemon, 2)
    except daemon_bench.CheckFailed:
        print(daemon.status()["account"], daemon.status()["camera"])
        raise
    of_camera = daemon.status()["map"]["known_voxels"]
    await_images(daemon, 5)
    expect("voxels of the camera after more images", of_camera, daemon.status()["map"]["known_voxels"])
    expect("readings by then", 0, used(daemon.status(), "readings"))
    node = start_node(bench)

    def has_all(status):
        time.sleep(0.3)  # asking costs the node time
        return (status["nodes"][0]["verdict"] == "usable" and status["account"]["readings"]["used"] >= 20 and
                all(sensor["received"] >= 5 for sensor in status["nodes"][0]["sensors"]) and
                all(status["nodes"][0]["sensors"][sensor]["rejected"] is None for sensor in TRUE_RANGE_M))
    try:
        daemon.await_status("readings of all sensors on the map", has_all, PATIENCE_S)
    except daemon_bench.CheckFailed:
        print(daemon.account(), daemon.status()["nodes"][0])
        raise
    status = daemon.status()
    for sensor, range_m in TRUE_RANGE_M.items():
        told = status["nodes"][0]["sensors"][sensor]
        claim(abs(told["range_m"] - range_m) <= 0.001, f"sensor {sensor}: {told}, it sees {range_m} m")
    expect_beams(status["map"]["known_voxels"] - of_camera)
    expect("frames not sent, lost", (0, 0), (status["can"]["not_sent"], status["can"]["dropped_by_kernel"]))
    claim(any("'second': absent" in problem for problem in status["problems"]), f"the missing node: {status['problems']}")
    unplugged_s, plugged_s = unplug_and_plug_in(daemon, plug)

    node.terminate()
    expect("exit code of the node", 0, node.wait(daemon_bench.PATIENCE_S))
    named_s = daemon.await_status("the lost node's name", lambda now: any("'first': lost" in text for text in now["problems"]))
    claim(named_s <= NAMED_S, f"the lost node was named after {named_s:.2f} s")
    daemon.stop()
    others = {frame.split("#")[0] for frame in listener.stop() if int(frame.split("#")[0], 16) & 63 not in (1, JOINT_NODE)}
    expect("identifiers of frames that no node sent", {"040", "080"}, others)
    print(f"{status['account']['readings']}, {of_camera} voxels of the camera, {status['map']['known_voxels']} with the sensors; "
          f"unplugged camera named after {unplugged_s:.2f} s, its frames on the map {plugged_s:.2f} s after it was back, a lost node named "
          f"after {named_s:.2f} s")


daemon_bench.run(check)
