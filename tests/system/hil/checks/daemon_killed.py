#!/usr/bin/env python3
"""SIGKILL at random moments, every other time in the midst of a save. Each time the map's files are whole and at most one save
old, and the next daemon goes on with that map. OCTOSKIN_HIL_KILLS times; the seed is printed, OCTOSKIN_HIL_SEED is one."""
import os
import random
import time

import daemon_bench
import map_file
from daemon_bench import RECORDING, claim, expect

SAVE_PERIOD_S = 1
SAVE_S = 1.0  # what the emulated processor may need to save: the moment of a save is that of its begin
UP_S = 5.0    # a daemon lives so long at most


class Life:
    """One daemon, from its start to SIGKILL."""

    def __init__(self, bench, maps, random_numbers, is_in_save):
        self.random, self.is_in_save = random_numbers, is_in_save
        self.daemon = bench.daemon("killed", "--listen-only", "--save-every", str(SAVE_PERIOD_S), maps=maps)
        self.known = []  # (when it was asked, known voxels)

    def note(self):
        status = self.daemon.status()
        self.known.append((time.time(), status["map"]["known_voxels"]))

    def await_begin_of_save(self):
        partial = self.daemon.maps / ".fused.ot.octoskin-part"
        end = time.monotonic() + daemon_bench.PATIENCE_S
        while not partial.exists() and time.monotonic() < end:  # a busy wait: it lasts a few milliseconds
            pass
        time.sleep(self.random.choice((0, self.random.uniform(0, 0.003))))

    def live(self):
        """Until it is killed; then when that was."""
        self.daemon.await_start()
        end = time.monotonic() + self.random.uniform(0, UP_S)
        self.note()
        while time.monotonic() < end:
            time.sleep(0.1)
            self.note()
        if self.is_in_save:
            self.await_begin_of_save()
        self.daemon.process.kill()
        killed = time.time()
        self.daemon.process.wait(daemon_bench.PATIENCE_S)
        return killed


def check_files(life, killed, saved_before):
    """Known voxels of the saved map, and how old it is."""
    maps = life.daemon.maps
    known = map_file.known_voxels(maps / "fused.ot")
    if (maps / "fused.bt").exists():
        map_file.known_voxels(maps / "fused.bt")
    age_s = killed - (maps / "fused.ot").stat().st_mtime
    lived_s = killed - life.known[0][0]
    claim(age_s <= SAVE_PERIOD_S + SAVE_S or lived_s < SAVE_PERIOD_S + SAVE_S, f"the map was saved {age_s:.2f} s before the end")
    before = [count for when, count in life.known if when <= killed - SAVE_PERIOD_S - SAVE_S]
    claim(known >= max([saved_before, *before]), f"{known} voxels saved; there were {max([saved_before, *before])}")
    return known, age_s if lived_s >= SAVE_PERIOD_S + SAVE_S else 0.0


def check(bench):
    count = int(os.environ.get("OCTOSKIN_HIL_KILLS", "4"))
    seed = int(os.environ.get("OCTOSKIN_HIL_SEED", random.SystemRandom().randrange(10_000)))
    numbers = random.Random(seed)
    print(f"seed {seed}", flush=True)
    oldest_s, partial = 0.0, 0
    # On the host's disk, where a write takes its time, and of a map that has some bytes: so that a save is long enough to be hit.
    maps = bench.folder_of_host()
    map_file.write_cube(maps / "fused.ot", 5)
    saved = map_file.known_voxels(maps / "fused.ot")
    playing = bench.start("canplayer", f"{daemon_bench.CAN}=can0", "-l", "i", "-I", str(RECORDING / "can.log"))
    for number in range(count):
        life = Life(bench, maps, numbers, is_in_save=number % 2 == 0)
        killed = life.live()
        expect(f"voxels that daemon {number} began with, at least", True, life.known[0][1] >= saved)
        saved, age_s = check_files(life, killed, saved)
        partial += len([name for name in os.listdir(life.daemon.maps) if name.startswith(".fused")])
        oldest_s = max(oldest_s, age_s)
    claim(playing.poll() is None, "canplayer ended")
    claim(partial > 0 or count < 20, "none was killed in the midst of a save")
    print(f"{count} times killed, {partial} in the midst of a save: the map always whole, {oldest_s:.2f} s old at most, "
          f"saved every {SAVE_PERIOD_S} s; {saved} voxels")


daemon_bench.run(check)
