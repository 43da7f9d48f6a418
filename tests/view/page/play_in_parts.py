#!/usr/bin/env python3
"""Sends the frames of a candump log at their recorded intervals, but for a while none with ranges.

usage: play_in_parts.py LOG FD

Meanwhile the map does not change, but the bus time goes on. Prints each part when it begins: playing, pausing, playing
again, after. A process of its own: a thread beside tests would send SYNC late.
"""
import pathlib
import re
import socket
import struct
import sys
import time

RANGES = range(0x200, 0x280)  # identifiers of RANGE and RANGE_FD: docs/protocol.md
PAUSE_S = (5.5, 12.0)


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


def part_at(at_s):
    return "playing" if at_s < PAUSE_S[0] else "pausing" if at_s < PAUSE_S[1] else "playing again"


def main(log, bus):
    frames = list(frames_of(log))
    begin, part = time.monotonic(), None
    for at_s, identifier, frame in frames:
        time.sleep(max(0.0, begin + at_s - time.monotonic()))
        if part_at(at_s) != part:
            part = part_at(at_s)
            print(part, flush=True)
        if part != "pausing" or identifier not in RANGES:
            bus.send(frame)
    print("after", flush=True)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), socket.socket(fileno=int(sys.argv[2])))
