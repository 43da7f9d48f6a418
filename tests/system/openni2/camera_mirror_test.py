#!/usr/bin/env python3
"""camera_mirror_test.py CAMERA-PROGRAM OPENNI2-FOLDER: left is left, of a camera that mirrors until it is told not to, and of one that
cannot be told; and a camera is put into the mode that is wanted, if it has it,
and tells the rate of the one that it is in. The folder has the driver of tests/support/camera_driver."""
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

HEADER = struct.Struct("4s5I")  # host/io/openni2/frame_pipe.cpp
LEFT_MM, RIGHT_MM = 1000, 2000


def first_row(program, openni2, mirrors, *mode):
    with tempfile.TemporaryDirectory() as scratch:
        camera = pathlib.Path(scratch, "camera")
        camera.write_text(f"{RIGHT_MM} {LEFT_MM}")
        environment = {**os.environ, "LD_LIBRARY_PATH": openni2, "OCTOSKIN_TEST_CAMERA": str(camera), **mirrors}
        with subprocess.Popen([program, "", *mode], stdout=subprocess.PIPE, env=environment) as process:
            magic, _, width, _, _, rate_mhz = HEADER.unpack(process.stdout.read(HEADER.size))
            assert magic == b"OSKD", magic
            time_us = struct.unpack("Q", process.stdout.read(8))[0]
            while time_us == 2**64 - 2:  # a frame without a time
                time_us = struct.unpack("Q", process.stdout.read(8))[0]
            row = struct.unpack(f"{width}H", process.stdout.read(2 * width))
            process.kill()
            return row, rate_mhz


for environment in ({}, {"OCTOSKIN_TEST_CAMERA_MIRRORS": "1"}):
    row, _ = first_row(sys.argv[1], sys.argv[2], environment)
    half = len(row) // 2
    assert set(row[:half]) == {LEFT_MM} and set(row[half:]) == {RIGHT_MM}, (environment, row)

# Another size; the only rate of that size; a size that it does not have; what it begins with.
for mode, width, rate_hz in (("160x120@30", 160, 30), ("160x120@5", 160, 30), ("640x480@30", 80, 2), ("80x60@2", 80, 2)):
    row, rate_mhz = first_row(sys.argv[1], sys.argv[2], {}, mode)
    assert (len(row), rate_mhz) == (width, 1000 * rate_hz), (mode, len(row), rate_mhz)
