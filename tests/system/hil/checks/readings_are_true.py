#!/usr/bin/env python3
"""readings_are_true.py FOLDER NODES: holds decoded readings of so many nodes (standard input, decode_log's lines) against what the
sensors truly ranged (FOLDER/ranged.i2c-N): range and status are a ranging's of that sensor, and its capture time is the middle of
that ranging, within the bound that the node tells, 12 ms at most. Of a reading that is not true it says all that is known: the
reading, its line among the decoded ones, and the rangings of its sensor that were nearest to it."""
import collections
import pathlib
import sys
import time

NODES = int(sys.argv[2])
SENSOR_OF = {(node, sensor): f"sensor{4 * (node - 1) + sensor}" for node in range(1, NODES + 1) for sensor in range(4)}
BOUND_MAX_US = 12_000  # on an emulated processor; a node that tells a longer one excuses nothing by it
RECORD_LATE_S = 10  # the record is written every 10 ms, by a thread that waits for the disk and for the processor

Ranging = collections.namedtuple("Ranging", "index middle_us ready_us status stream range_mm")
Reading = collections.namedtuple("Reading", "line node sensor status range_mm capture_us span_us sequence")


def read_truth(folder):
    """Sensor name -> its rangings, in their order."""
    truth = collections.defaultdict(list)
    for file in folder.glob("ranged.i2c-*"):
        for line in file.read_text().splitlines(keepends=True):
            if line.endswith("\n"):  # the last one may be being written
                name, *rest = line.split()
                truth[name].append(Ranging(*map(int, rest)))
    return truth


def read_said(lines):
    """All readings, and the bounds told of each sensor as (line, bound)."""
    readings = []
    bounds_us = collections.defaultdict(list)
    for number, line in enumerate(lines, 1):
        node, kind, *rest = line.split()
        if kind == "health":
            bounds_us[int(node), int(rest[0])].append((number, 64 * int(rest[3])))
        elif kind == "range":
            readings.append(Reading(number, int(node), *map(int, rest)))
    return readings, bounds_us


def bound_us(reading, told):
    """The longest that was told of its sensor; of a reading after which none was told any more, the longest that may be."""
    if not told or told[-1][0] < reading.line:
        return BOUND_MAX_US
    return min(max(bound for _, bound in told), BOUND_MAX_US)


def error_us(reading, ranging):
    """How far the capture time is from this ranging's middle, modulo the wire's span."""
    half = reading.span_us // 2
    return (reading.capture_us - ranging.middle_us + half) % reading.span_us - half


def is_same(reading, ranging):
    status = 9 if reading.status == 19 else reading.status
    return (status, reading.range_mm) == (ranging.status, ranging.range_mm)


def judge(readings, bounds_us, truth):
    """Each sensor's capture errors, and what is wrong: (reading, error, bound), the error None if nothing like it was ranged."""
    errors_us = collections.defaultdict(list)
    faults = []
    for reading in readings:
        key = reading.node, reading.sensor
        alike = [ranging for ranging in truth[SENSOR_OF[key]] if is_same(reading, ranging)]
        error = min((abs(error_us(reading, ranging)) for ranging in alike), default=None)
        bound = bound_us(reading, bounds_us[key])
        if error is None or error > bound + 64:
            faults.append((reading, error, bound))
        else:
            errors_us[key].append(error)
    return errors_us, faults


def explain(fault, bounds_us, truth):
    reading, error, bound = fault
    rangings = truth[SENSOR_OF[reading.node, reading.sensor]]
    print(f"not true: {reading}: off by {error} us from the nearest like it, bound {bound} us")
    print(f"  bounds told (line, us): {bounds_us[reading.node, reading.sensor]}")
    print(f"  {len(rangings)} rangings are recorded, the last {rangings[-1] if rangings else 'none'}; the nearest:")
    for ranging in sorted(rangings, key=lambda ranging: abs(error_us(reading, ranging)))[:5]:
        print(f"  {error_us(reading, ranging):+} us from {ranging}")


def main():
    folder = pathlib.Path(sys.argv[1])
    readings, bounds_us = read_said(sys.stdin)
    end = time.monotonic() + RECORD_LATE_S
    while True:
        truth = read_truth(folder)
        errors_us, faults = judge(readings, bounds_us, truth)
        if not faults or time.monotonic() > end:
            break
        time.sleep(1)
    for key, errors in sorted(errors_us.items()):
        told = max((bound for _, bound in bounds_us[key]), default=0)
        print(f"node {key[0]} sensor {key[1]}: {len(errors)} readings, capture time off by {max(errors)} us at most, bound {told} us")
    for fault in faults[:20]:
        explain(fault, bounds_us, truth)
    print(f"{len(readings)} readings, {len(faults)} not true")
    return 1 if faults or len(errors_us) != len(SENSOR_OF) else 0


if __name__ == "__main__":
    sys.exit(main())
