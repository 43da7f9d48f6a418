"""Decodes frames of our encoder with the shipped DBC by canmatrix, and compares every value.

    dbc_with_canmatrix.py <wire_frames program> <octoskin.dbc>

Exits with 77 (ctest: skipped) where canmatrix is not installed.
"""

import json
import logging
import subprocess
import sys

try:
    logging.disable(logging.WARNING)  # of formats that canmatrix lacks libraries for
    import canmatrix
    import canmatrix.formats
except ImportError as error:
    print(f"skipped: {error}; install python3-canmatrix")
    sys.exit(77)


def parsed(candump_line):
    """Identifier, whether it is CAN FD, and payload of a line of candump -L."""
    frame = candump_line.split()[2]
    identifier, _, data = frame.partition("#")
    is_fd = data.startswith("#")
    return int(identifier, 16), is_fd, bytes.fromhex(data[2:] if is_fd else data)


def differences(decoded, expected):
    """What canmatrix read otherwise than the sender meant it."""
    if set(decoded) != set(expected):
        yield f"signals {sorted(set(decoded) ^ set(expected))} are only on one side"
        return
    for name, value in expected.items():
        signal = decoded[name]
        if isinstance(value, dict):
            if (signal.raw_value, signal.named_value) != (value["raw"], value["name"]):
                yield f"{name}: {signal.raw_value} {signal.named_value}, sent {value}"
        elif abs(float(signal.phys_value) - value) > 1e-9:
            yield f"{name}: {signal.phys_value}, sent {value}"


def main(program, dbc_path):
    dbc = canmatrix.formats.loadp_flat(dbc_path)
    lines = subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()
    seen = set()
    failures = []
    for candump_line, expectation in zip(lines[0::2], lines[1::2], strict=True):
        identifier, is_fd, payload = parsed(candump_line)
        expected = json.loads(expectation)
        frame = dbc.frame_by_id(canmatrix.ArbitrationId(identifier, extended=False))
        if frame is None or frame.name != expected["message"] or frame.is_fd != is_fd:
            failures.append(f"{candump_line}: {frame} is not {expected['message']} (CAN FD: {is_fd})")
            continue
        decoded = frame.decode(payload.ljust(frame.size, b"\0") if is_fd else payload)
        failures += [f"{candump_line}: {text}" for text in differences(decoded, expected["signals"])]
        seen |= {(frame.name, name) for name in decoded}

    known = {(frame.name, signal.name) for frame in dbc.frames for signal in frame.signals}
    failures += [f"{frame} {signal}: never sent" for frame, signal in sorted(known - seen)]
    print(f"{len(lines) // 2} frames of {len(dbc.frames)} messages, {len(known)} signals, {len(failures)} differences")
    print("\n".join(failures[:20]))
    return 1 if failures or not lines else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
