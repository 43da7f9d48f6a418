#!/usr/bin/env python3
"""SIGKILL at random moments in the midst of a save: a partial file is left of each. Each time the map's files are whole and at most one
save old, and the next daemon goes on with that map. 50 times, or OCTOSKIN_HIL_KILLS; the seed is printed, OCTOSKIN_HIL_SEED is one.
A kill that comes after a save's end is looked at as well, and does not count.
Several daemons, each with a map of its own, hear one bus, so that one works while another waits for its save."""
import collections
import concurrent.futures
import os
import random
import time

import daemon_bench
import directory_watch
import map_file
from daemon_bench import RECORDING, claim, expect

SAVE_PERIOD_S = 1
SAVE_S = 1.0  # what the emulated processor may need to save: the moment of a save is that of its begin
UP_S = 1.5    # a daemon lives so long, at most, before it is killed or its next save is awaited
LONGER_S = 3  # and some so much longer: they have saved before
LANES = 3     # daemons at a time
MEASURED_SAVES = 3
TRIES = 4     # for each kill that counts
# How far into a save a kill is aimed, at most, after one that came in it, and after one that came too late: four of five come in it,
# whatever the machine does to a save's duration.
LONGER, SHORTER = 1.2, 0.5


class Life:
    """One daemon, from its start to SIGKILL."""

    def __init__(self, daemon, random_numbers, save_s, is_long):
        self.daemon, self.random, self.save_s = daemon, random_numbers, save_s
        self.up_s = random_numbers.uniform(0, UP_S) + (LONGER_S if is_long else 0)
        self.notes = []  # (when it was asked, what it said of its map)

    def note(self):
        self.notes.append((time.time(), self.daemon.status()["map"]))

    def await_moment_of_save(self):
        """A random one, from when the first file of a save is begun until the last one has its name, about."""
        with directory_watch.Watch(self.daemon.maps) as watch:
            watch.await_file(".fused.ot.octoskin-part", daemon_bench.PATIENCE_S)
        time.sleep(self.random.uniform(0, self.save_s))

    def measure_saves(self):
        """Seconds that each of some takes."""
        with directory_watch.Watch(self.daemon.maps) as watch:
            for _ in range(MEASURED_SAVES):
                watch.await_file(".fused.ot.octoskin-part", daemon_bench.PATIENCE_S)
                began = time.monotonic()
                watch.await_file("fused.bt", daemon_bench.PATIENCE_S)
                yield time.monotonic() - began

    def live(self):
        """Until it is killed; then when that was."""
        self.daemon.await_start()
        end = time.monotonic() + self.up_s
        self.note()
        while time.monotonic() < end:
            time.sleep(0.2)
            self.note()
        self.await_moment_of_save()
        self.daemon.process.kill()
        killed = time.time()
        self.daemon.process.wait(daemon_bench.PATIENCE_S)
        return killed

    def known_in_last_save(self):
        """Voxels, at least: what was known when the save before the last one was not over yet, for then the last had not begun."""
        saves = self.notes[-1][1]["saved"]
        return max((told["known_voxels"] for _, told in self.notes if told["saved"] <= saves - 2), default=0)

    def lived_s(self, killed):
        return killed - self.notes[0][0]

    def was_in_time(self):
        """No save was still under way when the next was due, and no answer kept us waiting: else the age of a save is the machine's."""
        asked = [when for when, _ in self.notes]
        return self.notes[-1][1]["saves_skipped"] == 0 and all(after - before < 0.5 for before, after in zip(asked, asked[1:]))


class Lane:
    """One map, and the daemons that had it one after the other."""

    def __init__(self, bench, name, random_numbers):
        self.bench, self.name, self.random = bench, name, random_numbers
        self.configuration = bench.without_weakening()
        # On a disk, where a write takes its time, and of a map that has some bytes: so that a save is long enough to be hit.
        self.maps = bench.folder_on_disk() / name
        self.maps.mkdir()
        map_file.write_cube(self.maps / "fused.ot", 4)
        self.saved = map_file.known_voxels(self.maps / "fused.ot")
        self.seen = collections.Counter()
        self.oldest_s = 0.0

    def start(self):
        return self.bench.daemon(self.name, "--listen-only", "--save-every", str(SAVE_PERIOD_S), *self.configuration, maps=self.maps)

    def measure_save(self):
        daemon = self.start()
        daemon.await_start()
        save_s = min(Life(daemon, self.random, 0, is_long=False).measure_saves())
        daemon.stop()
        self.saved = map_file.known_voxels(self.maps / "fused.ot")
        return save_s

    def kill(self, count):
        """So often in a save."""
        save_s = self.measure_save()
        while self.seen["in a save"] < count:
            number = self.seen["killed"]
            claim(number < TRIES * count, f"of {number} kills only {self.seen['in a save']} came in a save, aimed at {1e3 * save_s:.1f} ms")
            life = Life(self.start(), self.random, save_s, is_long=number % 5 == 4)
            killed = life.live()
            at_begin = life.notes[0][1]["known_voxels"]
            claim(at_begin >= self.saved, f"{at_begin} voxels at the begin, {self.saved} were saved")
            self.check_files(life, killed)
            self.seen["killed"] += 1
            was_in_save = any(name.startswith(".fused") for name in os.listdir(self.maps))
            self.seen["in a save"] += was_in_save
            save_s *= LONGER if was_in_save else SHORTER

    def check_files(self, life, killed):
        """They are whole, and at most one save old."""
        known = map_file.known_voxels(self.maps / "fused.ot")
        if (self.maps / "fused.bt").exists():
            map_file.known_voxels(self.maps / "fused.bt")
        claim(known >= max(self.saved, life.known_in_last_save()),
              f"{known} voxels saved, after {self.saved} before and {life.known_in_last_save()} in a save that was over")
        if life.lived_s(killed) >= SAVE_PERIOD_S + SAVE_S and life.was_in_time():
            age_s = killed - (self.maps / "fused.ot").stat().st_mtime
            claim(age_s <= SAVE_PERIOD_S + SAVE_S, f"the map was saved {age_s:.2f} s before the end")
            self.oldest_s = max(self.oldest_s, age_s)
            self.seen["lived through a save"] += 1
        self.saved = known


def check(bench):
    count = int(os.environ.get("OCTOSKIN_HIL_KILLS", "50"))
    seed = int(os.environ.get("OCTOSKIN_HIL_SEED", random.SystemRandom().randrange(10_000)))
    print(f"seed {seed}", flush=True)
    # Looks for what is due each 20 ms: each millisecond, that takes a seventh of the emulated processor.
    playing = bench.start("canplayer", f"{daemon_bench.CAN}=can0", "-l", "i", "-g", "20", "-I", str(RECORDING / "can.log"))
    lanes = [Lane(bench, f"killed{number}", random.Random(f"{seed} {number}")) for number in range(LANES)]
    with concurrent.futures.ThreadPoolExecutor(LANES) as pool:
        ends = [pool.submit(lane.kill, len(range(number, count, LANES))) for number, lane in enumerate(lanes)]
        for end in ends:
            end.result()
    claim(playing.poll() is None, "canplayer ended")
    seen = sum((lane.seen for lane in lanes), collections.Counter())
    expect("daemons killed in the midst of a save", count, seen["in a save"])
    print(f"{seen['killed']} times killed, {seen['in a save']} of them in the midst of a save: the map always whole; {seen['lived through a save']} had "
          f"time to save, {max(lane.oldest_s for lane in lanes):.2f} s before their end at most, saving every {SAVE_PERIOD_S} s")


daemon_bench.run(check)
