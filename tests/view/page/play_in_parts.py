#!/usr/bin/env python3
"""Sends the frames of a candump log at their recorded intervals, but for a while none with ranges.

usage: play_in_parts.py LOG FD

From BEGIN_S on no range is sent, until a line comes on standard input; then ranges for MORE_S, and it ends. Meanwhile
the map does not change, but the bus time goes on. Prints each part when it begins: playing, pausing, playing again,
after. A process of its own: a thread beside tests would send SYNC late.
"""
import pathlib
import re
import select
import socket
import struct
import sys
import time

RANGES = range(0x200, 0x280)  # identifiers of RANGE and RANGE_FD: docs/protocol.md
BEGIN_S = 6.0
MORE_S = 2.5


def frames_of(log):
    """(seconds since the first, bytes of the kernel's can_frame or canfd_frame) of a candump log."""
    first = None
    for line in log.read_text().splitlines():
        stamp, identifier, data = re.match(r"\(([\d.]+)\) \S+ ([0-9A-F]+)##?(.*)", line).groups()
        first = float(stamp) if first is None else first
        is_fd = "##" in line
        content = bytes.fromhex(data[1:] if is_fd else data)
        frame = struct.pack("<IB3x", int(identifier, 16), len(content)) + content.ljust(64 if is_fd else 8, b"\0")
        yield float(stamp) - first, int(identifier, 16), frame


def is_asked_to_go_on():
    return select.select([sys.stdin], [], [], 0)[0] != []


def main(log, bus):
    frames = list(frames_of(log))
    begin, part, again_s = time.monotonic(), "playing", None
    print(part, flush=True)
    for at_s, identifier, frame in frames:
        time.sleep(max(0.0, begin + at_s - time.monotonic()))
        if part == "playing" and at_s >= BEGIN_S:
            part = "pausing"
            print(part, flush=True)
        elif part == "pausing" and is_asked_to_go_on():
            part, again_s = "playing again", at_s
            print(part, flush=True)
        elif part == "playing again" and at_s > again_s + MORE_S:
            break
        if part != "pausing" or identifier not in RANGES:
            bus.send(frame)
    print("after", flush=True)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), socket.socket(fileno=int(sys.argv[2])))
