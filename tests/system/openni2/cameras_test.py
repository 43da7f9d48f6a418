#!/usr/bin/env python3
"""cameras_test.py OCTOSKIN OPENNI2-FOLDER: `octoskin cameras` lists a camera that is plugged in with its modes, and says so if none
is. The folder has the driver of tests/support/camera_driver."""
import os
import pathlib
import subprocess
import sys
import tempfile

LISTED = """\
test-camera
  octoskin, wall
  80 x 60 at 2 Hz  <- initial mode
  160 x 120 at 30 Hz
  80 x 60 at 2 Hz, not in millimetres: octoskin cannot read it
"""


def cameras(camera):
    environment = {**os.environ, "LD_LIBRARY_PATH": sys.argv[2], "OCTOSKIN_TEST_CAMERA": str(camera)}
    return subprocess.run([sys.argv[1], "cameras"], capture_output=True, text=True, env=environment, timeout=40)


with tempfile.TemporaryDirectory() as scratch:
    camera = pathlib.Path(scratch, "camera")
    none = cameras(camera)
    assert none.returncode == 69 and not none.stdout and "no camera found" in none.stderr, none
    camera.write_text("1000")
    one = cameras(camera)
    assert one.returncode == 0 and one.stdout == LISTED, one
