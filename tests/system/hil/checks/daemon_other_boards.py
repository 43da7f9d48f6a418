#!/usr/bin/env python3
"""Boards that must not come onto the map: one of another version of the wire, from its first frame on, and a second board with the
id of the first, from the moment that it turns up. The status names them, and there is no voxel that should not be there."""
import shutil

import daemon_bench
import wire_frames
from daemon_bench import RECORDING, claim, expect

NODE = 1
HEARTBEAT = 0x140 + NODE


def lines_of_log():
    return (RECORDING / "can.log").read_text().splitlines()


def frame_in(line):
    return line.split()[2]


def id_in(line):
    return int(frame_in(line).split("#")[0], 16)


def write_log(folder, lines):
    """A recording with these lines."""
    shutil.copytree(RECORDING, folder)
    (folder / "can.log").write_text("\n".join(lines) + "\n")
    return folder / "can.log"


def with_frame(line, frame):
    stamp, interface, _ = line.split()
    return f"{stamp} {interface} {frame}"


def names_it(status, verdict, words):
    node = status["nodes"][0]
    told = [problem["text"] for problem in status["problems"] if "node 1 'bench'" in problem["text"]]
    return node["verdict"] == verdict and any(words in problem for problem in told)


def voxels_of(replayed):
    """`.../fused.ot: 403 known voxels`"""
    return next(int(line.split()[-3]) for line in replayed.splitlines() if line.endswith("known voxels"))


def check_another_version(bench):
    assert all(wire_frames.is_sealed(frame_in(line)) for line in lines_of_log())  # what is changed below was right before
    lines = [with_frame(line, wire_frames.of_version(frame_in(line), 2)) if id_in(line) & 63 == NODE else line
             for line in lines_of_log()[:1500]]  # two seconds and a half are enough
    refused = sum(id_in(line) & 63 == NODE for line in lines)
    daemon = bench.daemon("another_version", "--listen-only")
    daemon.await_start()
    playing = bench.start_playing(write_log(bench.folder / "other", lines))
    daemon.await_status("the other version's name", lambda status: names_it(status, "other_version", "version"))
    told = [problem["text"] for problem in daemon.status()["problems"] if "bench" in problem["text"]]
    expect("exit code of canplayer", 0, playing.wait(daemon_bench.PATIENCE_S))
    daemon.await_frames(len(lines))
    status = daemon.status()
    expect("voxels", 0, status["map"]["known_voxels"])
    expect("frames refused", {"wrong_version": refused}, status["inputs"]["CAN frames"]["rejected"])
    expect("readings", 0, status["inputs"]["readings"]["in"])
    daemon.stop()
    print(f"another version: {told}, {refused} frames refused")


def check_a_second_board(bench):
    lines = lines_of_log()
    begin = 3 * len(lines) // 4
    both, begun = [], None
    for number, line in enumerate(lines):
        both.append(line)
        if number >= begin and id_in(line) == HEARTBEAT:
            begun = begun or number
            both.append(with_frame(line, wire_frames.of_another_board(frame_in(line))))
    alone = write_log(bench.folder / "alone", lines[:begun])
    daemon = bench.daemon("a_second_board", "--listen-only")
    daemon.await_start()
    playing = bench.start_playing(write_log(bench.folder / "both", both))
    # By then two heartbeats of the second board have come; from now on nothing may.
    daemon.await_status("the second board's name", lambda status: names_it(status, "quarantined", "two boards"))
    named = daemon.status()
    told = [problem["text"] for problem in named["problems"] if "bench" in problem["text"]]
    expect("exit code of canplayer", 0, playing.wait(daemon_bench.PATIENCE_S))
    daemon.await_frames(len(both))
    status = daemon.status()
    used, voxels = status["inputs"]["readings"]["used"], status["map"]["known_voxels"]
    claim(used > 0 and voxels > 0, "what came before counts")
    expect("readings used, and voxels, since it was named", (0, 0),
           (used - named["inputs"]["readings"]["used"], voxels - named["map"]["known_voxels"]))
    expect("voxels that the first board alone does not make", True, voxels <= voxels_of(bench.replay(alone.parent, "--fused-only")))
    daemon.stop()
    print(f"a second board: {told}; {status['inputs']['readings']}")


def check(bench):
    check_another_version(bench)
    check_a_second_board(bench)


daemon_bench.run(check)
