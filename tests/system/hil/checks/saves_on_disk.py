#!/usr/bin/env python3
"""saves_on_disk.py until-cut|after-cut: the map on the machine's own disk, a file system made by the test.
until-cut: a daemon saves there every second; what it knows is told in the machine's folder, until the power goes.
after-cut: what is on the disk is a whole map, at most one save old, and a daemon goes on with it."""
import os
import pathlib
import sys
import time

import daemon_bench
import machine_disk
import map_file
from daemon_bench import RECORDING, claim, expect
from machine_disk import DISK

MAPS = DISK / "maps"
TOLD = pathlib.Path(os.environ["HIL_FOLDER"]) / "told"  # "seconds known-voxels" of each moment
OLD_S = 1 + 1.0  # a save a second, and what the emulated processor may need for one


def until_cut(bench):
    machine_disk.mounted()
    MAPS.mkdir(exist_ok=True)
    if not (MAPS / "fused.ot").exists():
        map_file.write_cube(MAPS / "fused.ot", 4)  # a save is more than one block
        os.sync()
    daemon = bench.daemon("cut", "--listen-only", "--save-every", "1", *bench.without_weakening(), maps=MAPS)
    daemon.await_start()
    bench.start("canplayer", f"{daemon_bench.CAN}=can0", "-l", "i", "-I", str(RECORDING / "can.log"))
    daemon.await_status("a save", lambda status: status["map"]["saved"] > 0)
    (DISK / "not_flushed").write_text("by nobody")
    with open(TOLD, "w", encoding="utf-8") as told:
        while True:  # until the power is cut
            status = daemon.status()
            told.write(f"{time.monotonic()} {status['map']['known_voxels']} {status['map']['saves_failed']}\n")
            told.flush()
            time.sleep(0.05)


def after_cut(bench):
    machine_disk.mounted()
    lost = DISK / "not_flushed"
    claim(not lost.exists() or lost.read_text() != "by nobody", "the cut was none: what nobody flushed is there")
    lost.unlink(missing_ok=True)  # ext4 flushes what is written in place of what there was
    moments = [line.split() for line in TOLD.read_text().splitlines(keepends=True) if line.endswith("\n")]
    expect("failed saves", {"0"}, {failed for _, _, failed in moments})
    end = float(moments[-1][0])
    before = [int(known) for when, known, _ in moments if float(when) <= end - OLD_S]
    saved = map_file.known_voxels(MAPS / "fused.ot")
    binary = map_file.known_voxels(MAPS / "fused.bt")
    claim(saved >= max(before, default=0), f"{saved} voxels saved, {max(before, default=0)} were known {OLD_S} s before the cut")
    daemon = bench.daemon("next", "--listen-only", maps=MAPS)
    daemon.await_start()
    expect("voxels that the next daemon begins with", saved, daemon.status()["map"]["known_voxels"])
    daemon.stop()
    left = [name for name in os.listdir(MAPS) if name.startswith(".fused")]
    expect("leftovers of a save", [], left)
    print(f"after {end - float(moments[0][0]):.1f} s of saves: {saved} voxels in fused.ot, {binary} in fused.bt, "
          f"{moments[-1][1]} were known at the cut")


def check(bench):
    until_cut(bench) if sys.argv[1] == "until-cut" else after_cut(bench)


daemon_bench.run(check)
