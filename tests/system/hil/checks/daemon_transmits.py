#!/usr/bin/env python3
"""What is sent, heard by candump beside recorded traffic. By the daemon: SYNC and its FOLLOW_UP once a second, and nothing else,
whatever comes in and whatever it is asked; with --listen-only nothing at all. By `octoskin joints`: the rig's joint node. By
`octoskin calibrate`: one command to the node it names, said three times at most."""
import collections
import shutil
import signal
import subprocess
import time

import daemon_bench
import wire_frames
from daemon_bench import CAN, OCTOSKIN, RECORDING, claim, expect, frames_of

SYNC, FOLLOW_UP, COMMAND_TO_1 = 0x040, 0x080, 0x0C1
JOINT_NODE = 10
HEARTBEAT, JOINT_STATE, SYNC_REPORT, NODE_INFO = (type * 64 + JOINT_NODE for type in (5, 6, 7, 11))


def id_of(frame):
    return int(frame.split("#")[0], 16)


def nodes_log(bench, name, share):
    """What the nodes of the recording said: without its host's frames. In the middle a board of another version, a second board
    with the same id, and frames of nobody, as more reasons to say something. `share` of it, from the begin."""
    lines = [line for line in (RECORDING / "can.log").read_text().splitlines() if id_of(line.split()[2]) not in (SYNC, FOLLOW_UP)]
    lines = lines[:int(share * len(lines))]
    place = next(number for number, line in enumerate(lines) if number > len(lines) // 2 and " 141#" in line)
    stamp, interface, heartbeat = lines[place].split()
    more = [wire_frames.of_version(heartbeat, 2), wire_frames.of_another_board(heartbeat), "0C1#00", "381#0102", "100#00"]
    log = bench.folder / name
    log.write_text("\n".join([*lines[:place], *(f"{stamp} {interface} {frame}" for frame in more), *lines[place:]]) + "\n")
    return log


def heard_while_busy(bench, daemon, log):
    """Lines of candump while the nodes talk, and the daemon records, is asked, and reads its rig again."""
    listener = bench.listener()
    playing = bench.start_playing(log)
    recording = bench.start(OCTOSKIN, "record", daemon.folder / "recorded", "--socket", daemon.socket, "--seconds", "1")
    daemon.process.send_signal(signal.SIGHUP)
    expect("exit code of octoskin record", 0, recording.wait(daemon_bench.PATIENCE_S))
    expect("exit code of canplayer", 0, playing.wait(daemon_bench.PATIENCE_S))
    time.sleep(0.5)  # for an answer to what came last
    listener.stop()
    shutil.rmtree(daemon.folder / "recorded")
    return listener.log.read_text().splitlines()


def check_listen_only(bench, log):
    daemon = bench.daemon("listening", "--listen-only")
    daemon.await_start()
    heard = heard_while_busy(bench, daemon, log)
    counts = daemon.status()["can"]
    daemon.stop()
    expect("frames on the bus", frames_of(log), [line.split()[2] for line in heard])
    expect("frames sent, and not sent", (0, 0), (counts["sent"], counts["not_sent"]))
    expect("times the socket was opened again, for a rig read again", 0, counts["reopened"])
    print(f"--listen-only: {len(heard)} frames played and heard, none sent")


def check_sync(bench, log):
    daemon = bench.daemon("sending")
    daemon.await_start()
    heard = heard_while_busy(bench, daemon, log)
    daemon.stop()
    own = [line.split() for line in heard if id_of(line.split()[2]) in (SYNC, FOLLOW_UP)]
    theirs = [line.split()[2] for line in heard if id_of(line.split()[2]) not in (SYNC, FOLLOW_UP)]
    expect("frames of others on the bus", frames_of(log), theirs)
    claim(all(wire_frames.is_sealed(frame) for _, _, frame in own), f"checksums: {own}")
    syncs = [(float(stamp.strip("()")), wire_frames.parsed(frame)[1]) for stamp, _, frame in own if id_of(frame) == SYNC]
    follow_ups = [wire_frames.parsed(frame)[1] for _, _, frame in own if id_of(frame) == FOLLOW_UP]
    expect("first byte of each FOLLOW_UP, as of its SYNC", [data[0] for _, data in syncs], [data[0] for data in follow_ups])
    sequences = [data[0] >> 3 for _, data in syncs]
    expect("sequences", [(sequences[0] + i) % 32 for i in range(len(sequences))], sequences)
    expect("versions", {1}, {data[0] & 7 for _, data in syncs})
    for (stamp, _), (next_stamp, _), data, next_data in zip(syncs, syncs[1:], follow_ups, follow_ups[1:]):
        told_s = (int.from_bytes(next_data[1:7], "little") - int.from_bytes(data[1:7], "little")) * 1e-6
        claim(next_stamp - stamp > 0.9, f"SYNC after {next_stamp - stamp:.3f} s")
        claim(abs(told_s - (next_stamp - stamp)) < 0.01, f"FOLLOW_UP tells {told_s:.6f} s between two SYNCs, candump heard "
              f"{next_stamp - stamp:.6f} s")
    claim(len(syncs) >= 4, f"SYNC: {len(syncs)}")
    print(f"the daemon: {len(syncs)} SYNC, {len(follow_ups)} FOLLOW_UP, none else beside {len(theirs)} frames of others")


def check_joints(bench):
    listener = bench.listener()
    joints = subprocess.Popen([OCTOSKIN, "joints", "--can", CAN, "--rig", RECORDING / "rig.yaml"], stdin=subprocess.PIPE, text=True)
    bench.end_with_us(joints)
    samples = 0

    def has_sent_ten():
        nonlocal samples
        samples += 1
        joints.stdin.write("0 0 0 -1.5 0 1.5 0\n")
        joints.stdin.flush()
        return sum(id_of(frame) == JOINT_STATE for frame in frames_of(listener.log)) >= 40
    daemon_bench.wait_until("ten samples of octoskin joints", has_sent_ten)
    joints.stdin.close()
    expect("exit code of octoskin joints", 0, joints.wait(daemon_bench.PATIENCE_S))
    heard = listener.stop()
    counts = collections.Counter(id_of(frame) for frame in heard)
    claim(set(counts) <= {HEARTBEAT, JOINT_STATE, SYNC_REPORT, NODE_INFO}, f"somebody else's identifier: {counts}")
    claim(counts[JOINT_STATE] % 4 == 0 and 0 < counts[JOINT_STATE] <= 4 * samples, f"four frames a sample: {counts}")
    claim(all(wire_frames.is_sealed(frame) for frame in heard), "checksums")
    print("octoskin joints:", {f"{key:03X}": count for key, count in counts.items()})


def check_command(bench):
    """The recorded node does not answer; before it asks, calibrate waits for a heartbeat."""
    log = RECORDING / "can.log"
    listener = bench.listener()
    playing = bench.start_playing(log)
    calibrating = bench.start(OCTOSKIN, "calibrate", "offset", "--rig", RECORDING / "rig.yaml", "--sensor", "front", "--target-mm",
                              "140", "--can", CAN)
    claim(calibrating.wait(daemon_bench.PATIENCE_S) != 0, "octoskin calibrate has a result of a node that does not answer")
    playing.kill()
    playing.wait()
    heard = listener.stop()
    commands = [frame for frame in heard if id_of(frame) == COMMAND_TO_1]
    claim(1 <= len(commands) <= 3 and len(set(commands)) == 1, f"commands: {commands}")
    data = wire_frames.parsed(commands[0])[1]
    expect("code, sensor, target of the command, and its checksum", (9, 0, 140, True),
           (data[0] >> 3, data[1] & 63, int.from_bytes(data[2:4], "little"), wire_frames.is_sealed(commands[0])))
    rest = [frame for frame in heard if frame not in commands]
    expect("frames of others on the bus", frames_of(log)[:len(rest)], rest)
    print(f"octoskin calibrate: {commands[0]}, {len(commands)} times")


def check(bench):
    check_listen_only(bench, nodes_log(bench, "begin.log", 0.4))
    check_sync(bench, nodes_log(bench, "whole.log", 1.0))
    check_joints(bench)
    check_command(bench)


daemon_bench.run(check)
