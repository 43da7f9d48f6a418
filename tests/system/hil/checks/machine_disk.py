"""The machine's own disk: /dev/vda, on which the test that booted it has made a file system."""
import os
import pathlib
import subprocess

DEVICE = pathlib.Path("/dev/vda")
DISK = pathlib.Path("/run/disk")


def mounted():
    """Where it is; None on a machine without, or where the checks run without a virtual machine."""
    if os.environ["HIL_KIND"] == "native" or not DEVICE.is_block_device():
        return None
    DISK.mkdir(exist_ok=True)
    if not DISK.is_mount():
        subprocess.run(["mount", "-t", "ext4", DEVICE, DISK], check=True)
    return DISK
