#!/usr/bin/env python3
"""A machine with a real kernel's CAN, GPIO and I2C, in which commands are run one by one.

    machine.py boot [--bin FOLDER] [--disk FILE] [--bare] FOLDER
                                                     start it, leave it running; bare: with CAN, without the boards;
                                                     with a disk, made if it is not there
    machine.py run [--seconds N] FOLDER COMMAND...   run a command inside; its output and exit code become ours
    machine.py stop FOLDER
    machine.py cut FOLDER                            its power is gone: what it had not flushed to its disk is lost

FOLDER holds what is known of the machine: its console, and of each command the script, the output and the exit code.
Where this kernel has what it takes, the machine is this one, with interfaces, processes and /run of its own; else a virtual one,
with this machine's own files, read-only, whose only place to write to is FOLDER. boot says which, and why; OCTOSKIN_HIL=native or
OCTOSKIN_HIL=virtual decides.
Exit codes of its own: 77 nothing to boot with, 124 a time limit is over, 125 the machine is not as it should be.
"""
import argparse
import contextlib
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time

sys.dont_write_bytecode = True  # nothing of root's in the source tree
from machine_kinds import (BROKEN, BUSYBOX, ENVIRONMENT, HERE, KERNEL, PROJECT, QEMU, TIME_OVER, MachineError, NativeMachine,
                           VirtualMachine, is_root, own_namespaces)

SKIPPED = 77
PREPARE_S = 120
# As board.sh wires them.
BOARD_DEVICES = [pathlib.Path(f"/dev/i2c-{bus}") for bus in (7, 8, 9, 10)]


def native_lacks(board):
    """Why a native machine cannot be; None if it can. Changes nothing, but that the kernel may load its module vcan."""
    if pathlib.Path("/run") in HERE.parents:
        return f"a native machine has a /run of its own, and {HERE} lies below it"
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError as error:
        return f"this kernel has no CAN sockets ({error.strerror})"
    try:
        probe = subprocess.run(own_namespaces(HERE / "native_init.sh", "probe"), capture_output=True, text=True, check=False,
                               env=ENVIRONMENT)
    except OSError as error:
        return f"{error.filename}: {error.strerror}"
    if probe.returncode != 0:
        return f"this kernel has no vcan, or we have no right to make one ({' '.join(probe.stderr.split())})"
    return boards_lack() if board == "up" else None


def boards_lack():
    if not is_root():
        return "only root can make GPIO lines and I2C buses"
    if not pathlib.Path("/sys/kernel/config/gpio-sim").is_dir():
        return "there is no gpio-sim (modprobe gpio-sim)"
    if not pathlib.Path("/dev/cuse").exists():
        return "there is no CUSE (modprobe cuse)"
    # An adapter is there without its device, until somebody loads i2c-dev.
    there = [str(device) for device in BOARD_DEVICES
             if device.exists() or pathlib.Path("/sys/bus/i2c/devices", device.name).exists()]
    return f"{there[0]} is there already" if there else None


def virtual_lacks():
    """Why a virtual machine cannot be booted; None if it can."""
    if shutil.which(QEMU) is None:
        return f"{QEMU} is not installed (toolchains/install_packages hil)"
    if not BUSYBOX.exists() or shutil.which("cpio") is None:
        return "busybox-static or cpio is not installed (toolchains/install_packages hil)"
    if not (KERNEL / "modules.load").exists():
        return f"no kernel in {KERNEL} (toolchains/fetch_hil_kernel)"
    return None


def choose(asked, why_not_native, why_not_virtual):
    """(kind, why it is this one). `asked` is OCTOSKIN_HIL; the others tell what a kind lacks, None if nothing, and are only called if
    that decides."""
    if asked not in ("", "native", "virtual"):
        raise MachineError(f"OCTOSKIN_HIL={asked}: native, virtual, or nothing to have boot decide")
    if asked != "virtual":
        lacks = why_not_native()
        if lacks is None:
            has_all = "this kernel has what it takes (OCTOSKIN_HIL=virtual boots a virtual machine)"
            return "native", "OCTOSKIN_HIL=native" if asked else has_all
        if asked:
            raise MachineError(f"skipped: OCTOSKIN_HIL=native, but {lacks}", SKIPPED)
    if why := why_not_virtual():
        raise MachineError(f"skipped: {why}" + ("" if asked else f"; and without a virtual machine: {lacks}"), SKIPPED)
    return "virtual", "OCTOSKIN_HIL=virtual" if asked else lacks


def make_anew(folder):
    """Empty; a folder that was no machine's is not touched."""
    if folder.is_dir() and any(folder.iterdir()) and not any((folder / name).exists() for name in ("kind", "skipped", "pid")):
        raise MachineError(f"{folder} is not empty and not a machine's: name another folder")
    try:
        with contextlib.suppress(MachineError):
            machine_in(folder).kill()  # left over from a run that was broken off
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir(parents=True)
    except OSError as error:
        raise MachineError(f"{error.filename or folder}: {error.strerror}; a machine of another user's? Its owner can stop and remove it") from error


def boot(folder, binaries, board, disk):
    make_anew(folder)
    try:
        boot_in(folder, binaries, board, disk)
    except MachineError as error:
        if error.code == SKIPPED:
            (folder / "skipped").write_text(str(error))
        raise


def boot_in(folder, binaries, board, disk):
    began = time.monotonic()
    kind, why = choose(os.environ.get("OCTOSKIN_HIL", ""), lambda: native_lacks(board), virtual_lacks)
    print(f"{kind} machine: {why}", flush=True)
    (folder / "kind").write_text(kind)
    machine = NativeMachine(folder) if kind == "native" else VirtualMachine(folder, disk, 2 if board == "up" else 1)
    machine.boot()
    up = time.monotonic()
    code, output = machine.run([str(HERE / "board.sh"), board, str(folder), str(binaries)], PREPARE_S)
    if code != 0:
        machine.kill()
        raise MachineError(output.decode(errors="replace").strip(), SKIPPED if code == SKIPPED else BROKEN)
    print(f"up after {up - began:.1f} s, its board after {time.monotonic() - up:.1f} s more")


def machine_in(folder):
    if (folder / "skipped").exists():
        raise MachineError((folder / "skipped").read_text(), SKIPPED)
    if not (folder / "kind").exists():
        raise MachineError(f"no machine in {folder}; boot it first")
    return NativeMachine(folder) if (folder / "kind").read_text() == "native" else VirtualMachine(folder)


def cut(folder):
    machine = machine_in(folder)
    if machine.kind == "native":
        raise MachineError("this machine's own power is not cut")
    machine.kill()


def run(folder, command, seconds):
    began = time.monotonic()
    code, output = machine_in(folder).run(command, seconds)
    sys.stdout.buffer.write(output)
    sys.stdout.flush()
    print(f"{time.monotonic() - began:.1f} s, exit code {code}" + (": time limit" if code == TIME_OVER else ""))
    return code


def parsed_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    for verb in ("boot", "run", "stop", "cut"):
        verbs.add_parser(verb).add_argument("folder", type=lambda text: pathlib.Path(text).resolve())
    verbs.choices["boot"].add_argument("--bin", type=pathlib.Path, default=PROJECT / "build/host-release/bin")
    verbs.choices["boot"].add_argument("--disk", type=pathlib.Path)
    verbs.choices["boot"].add_argument("--bare", dest="board", action="store_const", const="can", default="up")
    verbs.choices["run"].add_argument("--seconds", type=int, default=30)
    verbs.choices["run"].add_argument("command", nargs=argparse.REMAINDER)
    return parser.parse_args()


def main():
    arguments = parsed_arguments()
    try:
        if arguments.verb == "boot":
            boot(arguments.folder, arguments.bin.resolve(), arguments.board, arguments.disk)
        elif arguments.verb == "run":
            return run(arguments.folder, arguments.command, arguments.seconds)
        elif arguments.verb == "cut":
            cut(arguments.folder)
        else:
            machine_in(arguments.folder).stop()
    except MachineError as error:
        print(f"machine: {error}")
        return error.code
    return 0


if __name__ == "__main__":
    sys.exit(main())
