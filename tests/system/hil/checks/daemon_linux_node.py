#!/usr/bin/env python3
"""Sensors and a camera to one map: a Linux node with four sensors, an arm at rest, a camera of OpenNI2, and the daemon whose SYNC
the node follows. The ranges in the status are what the sensors truly see, and their beams are on the map, where the camera's images
of a wall that stands still add nothing any more; a camera that is unplugged, and a node that is stopped, are
named, while the others go on; nobody else sends anything. One node of the rig's two: beside a camera, the emulated processor has
no time left for both."""
import math
import time

import daemon_bench
from daemon_bench import claim, expect
from linux_node_bench import JOINT_NODE, PATIENCE_S, RIG, TRUE_RANGE_M, OnMap, keep_arm_at_rest, start_node, used, wrong_ranges

WALL_MM = 1500
# Three periods of a camera of 2 Hz, and on an emulated processor the answers to the questions beside a node that ranges.
CAMERA_NAMED_S = daemon_bench.limit_s(1.6, 0.9)
# It is looked for each second, and five of its frames tell its clock first, at 2 Hz: 3.5 s, and its helper's start. That start takes an
# emulated processor seconds, and a frame that comes 20 ms late tells nothing.
CAMERA_BACK_S = daemon_bench.limit_s(5.0, 3.0)
NAMED_S = daemon_bench.limit_s(1.0, 0.3)  # 0.35 s without a heartbeat; and the emulated processor's answers
MOVING_RANGE_M = 1.0  # of sensor 2, at most, mostly on the arm itself; 3 sees nothing
RESOLUTION_M = 0.04


def await_images(daemon, count):
    """So many more of them on the map."""
    before = used(daemon.status(), "depth frames")
    daemon.await_status(f"{count} images on the map", lambda now: used(now, "depth frames") >= before + count, PATIENCE_S)


def expect_beams(added):
    """A beam of length l leads through l / resolution voxels at least, along an axis, and through sqrt(3) times as many and one for
    each axis at most. Of the arm at rest, each sensor's are the same voxels again and again; no two sensors look the same way."""
    ranges_m = TRUE_RANGE_M["first"].values()
    at_least = sum(int(range_m / RESOLUTION_M) for range_m in ranges_m)
    at_most = sum(math.sqrt(3) * range_m / RESOLUTION_M + 3 for range_m in (*ranges_m, MOVING_RANGE_M))
    claim(at_least <= added <= at_most, f"voxels of the sensors: {added}, wanted {at_least} to {at_most:.0f}")


def has_camera_problem(status):
    return any(problem.get("on") == "camera" for problem in status["problems"])


def unplug_and_plug_in(daemon, plug):
    """The camera, while the node ranges: what that took, in seconds."""
    opened, before = daemon.status()["cameras"][0]["opened"], used(daemon.status(), "readings")
    plug.unlink()
    named_s = daemon.await_status("the camera's name", lambda now: has_camera_problem(now))
    claim(named_s <= CAMERA_NAMED_S, f"the camera that is gone was named after {named_s:.2f} s")
    daemon.await_status("an end of it", lambda now: not now["cameras"][0]["open"] and "no camera" in now["cameras"][0]["why"])
    daemon.await_status("readings without a camera", lambda now: used(now, "readings") > before, PATIENCE_S)
    gone = used(daemon.status(), "depth frames")
    plug.write_text(f"{WALL_MM}\n")
    back_s = daemon.await_status("the camera's frames again", lambda now: used(now, "depth frames") > gone, PATIENCE_S)
    claim(back_s <= CAMERA_BACK_S, f"the camera's frames were on the map {back_s:.2f} s after it was back")
    status = daemon.status()
    claim(status["cameras"][0]["open"] and status["cameras"][0]["opened"] > opened, f"the camera: {status['cameras'][0]}")
    claim(not has_camera_problem(status), f"problems: {status['problems']}")
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
        print(daemon.status()["inputs"], daemon.status()["cameras"][0])
        raise
    of_camera = daemon.status()["map"]["known_voxels"]
    await_images(daemon, 5)
    expect("voxels of the camera after more images", of_camera, daemon.status()["map"]["known_voxels"])
    expect("readings by then", 0, used(daemon.status(), "readings"))
    node = start_node(bench, "first")
    is_on_map = OnMap(["first"])

    def has_all(status):
        time.sleep(0.3)  # asking costs the node time
        return used(status, "readings") >= 20 and is_on_map(status)
    try:
        daemon.await_status("readings of all sensors on the map", has_all, PATIENCE_S)
    except daemon_bench.CheckFailed:
        print(daemon.account(), daemon.status()["nodes"][0])
        raise
    status = daemon.status()
    expect("wrong ranges", [], wrong_ranges(status, "first"))
    expect_beams(status["map"]["known_voxels"] - of_camera)
    expect("frames not sent, lost", (0, 0), (status["can"]["not_sent"], status["can"]["dropped_by_kernel"]))
    claim(daemon_bench.has_sentence(status, "'second': absent"), f"the missing node: {status['problems']}")
    unplugged_s, plugged_s = unplug_and_plug_in(daemon, plug)

    node.terminate()
    expect("exit code of the node", 0, node.wait(daemon_bench.PATIENCE_S))
    named_s = daemon.await_status("the lost node's name", lambda now: daemon_bench.has_sentence(now, "'first': lost"))
    claim(named_s <= NAMED_S, f"the lost node was named after {named_s:.2f} s")
    daemon.stop()
    others = {frame.split("#")[0] for frame in listener.stop() if int(frame.split("#")[0], 16) & 63 not in (1, JOINT_NODE)}
    expect("identifiers of frames that no node sent", {"040", "080"}, others)
    print(f"{status['inputs']['readings']}, {of_camera} voxels of the camera, {status['map']['known_voxels']} with the sensors; "
          f"unplugged camera named after {unplugged_s:.2f} s, its frames on the map {plugged_s:.2f} s after it was back, a lost node named "
          f"after {named_s:.2f} s")


daemon_bench.run(check)
