#!/usr/bin/env python3
"""readings_are_true.py FOLDER NODES: holds decoded readings of so many nodes (standard input, decode_log's lines) against what the
sensors truly ranged (FOLDER/ranged.i2c-N): range and status are a ranging's of that sensor, and its capture time is the middle of
that ranging, within the bound that the node tells, 12 ms at most."""
import collections
import pathlib
import sys

NODES = int(sys.argv[2])
SENSOR_OF = {(node, sensor): f"sensor{4 * (node - 1) + sensor}" for node in range(1, NODES + 1) for sensor in range(4)}
BOUND_MAX_US = 12_000  # on an emulated processor; a node that tells a longer one excuses nothing by it
NO_TARGET = 4  # the device's code: signal too weak, no range


def read_truth(folder):
    """Sensor name -> (status, range) -> middles of its rangings, microseconds."""
    truth = collections.defaultdict(lambda: collections.defaultdict(list))
    for file in folder.glob("ranged.i2c-*"):
        for line in file.read_text().splitlines():
            name, _, middle_us, _, status, _, range_mm = line.split()
            truth[name][int(status), int(range_mm)].append(int(middle_us))
    return truth


def error_us(capture_us, span_us, middles_us):
    """How far the capture time is from the nearest of them, modulo the wire's span."""
    half = span_us // 2
    return min((abs((middle - capture_us + half) % span_us - half) for middle in middles_us), default=None)


def main():
    truth = read_truth(pathlib.Path(sys.argv[1]))
    bounds_us = collections.defaultdict(int)
    readings = []
    for line in sys.stdin:
        node, kind, *rest = line.split()
        if kind == "health":
            bounds_us[int(node), int(rest[0])] = max(bounds_us[int(node), int(rest[0])], 64 * int(rest[3]))
        elif kind == "range":
            readings.append((int(node), *map(int, rest)))
    worst_us = collections.defaultdict(int)
    counts = collections.Counter()
    faults = []
    for node, sensor, status, range_mm, capture_us, span_us, _ in readings:
        middles_us = truth[SENSOR_OF[node, sensor]][9 if status == 19 else status, range_mm]
        error = error_us(capture_us, span_us, middles_us)
        if error is None or error > min(bounds_us[node, sensor], BOUND_MAX_US) + 64:
            faults.append(f"node {node} sensor {sensor}: status {status}, {range_mm} mm at {capture_us} us is no ranging of it: "
                          f"off by {error} us, bound {bounds_us[node, sensor]} us")
            continue
        counts[node, sensor] += 1
        worst_us[node, sensor] = max(worst_us[node, sensor], error)
    for key in sorted(counts):
        print(f"node {key[0]} sensor {key[1]}: {counts[key]} readings, capture time off by {worst_us[key]} us at most, "
              f"bound {bounds_us[key]} us")
    print("\n".join(faults[:20]))
    print(f"{len(readings)} readings, {len(faults)} not true")
    return 1 if faults or len(counts) != len(SENSOR_OF) else 0


if __name__ == "__main__":
    sys.exit(main())
