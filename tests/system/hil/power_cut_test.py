#!/usr/bin/env python3
"""power_cut_test.py FOLDER BIN: a daemon saves its map on a virtual disk, the power is cut at a random moment, the machine boots again:
the map is whole, and the next daemon goes on with it. Three times, or OCTOSKIN_HIL_POWER_CUTS, on a machine of its own; the seed is
printed, OCTOSKIN_HIL_SEED is one. The machine is always a virtual one; skipped if it cannot be, or may not (OCTOSKIN_HIL=native)."""
import os
import pathlib
import random
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
MACHINE = HERE / "machine.py"
SKIPPED = 77
VIRTUAL = {**os.environ, "OCTOSKIN_HIL": "virtual"}
SAVING_S = 4.0  # the power goes within so long
PATIENCE_S = 120


def machine(*arguments, **options):
    return subprocess.run([sys.executable, MACHINE, *map(str, arguments)], check=False, env=VIRTUAL, **options)


class PowerCuts:
    def __init__(self, folder, binaries):
        self.folder, self.binaries, self.disk = folder, binaries, folder.with_suffix(".disk")
        self.disk.unlink(missing_ok=True)

    def boot(self):
        if code := machine("boot", "--bin", self.binaries, "--disk", self.disk, "--bare", self.folder).returncode:
            sys.exit(code)

    def cut_while_saving(self, seconds):
        told = self.folder / "told"
        told.unlink(missing_ok=True)
        saving = subprocess.Popen([sys.executable, MACHINE, "run", "--seconds", str(PATIENCE_S), self.folder,
                                   HERE / "checks/saves_on_disk.py", "until-cut"], stdout=subprocess.PIPE, text=True)
        end = time.monotonic() + PATIENCE_S
        while not (told.exists() and told.stat().st_size):
            if saving.poll() is not None or time.monotonic() > end:
                machine("stop", self.folder)
                sys.exit(f"FAILED: nothing is saved:\n{saving.stdout.read()}")
            time.sleep(0.02)
        time.sleep(seconds)
        machine("cut", self.folder)
        saving.kill()
        saving.wait()
        return told.read_text()

    def check_after(self, told):
        """On a machine that has just booted with that disk."""
        (self.folder / "told").write_text(told)
        code = machine("run", "--seconds", PATIENCE_S, self.folder, HERE / "checks/saves_on_disk.py", "after-cut").returncode
        if code:
            machine("stop", self.folder)
            sys.exit(code)


def main():
    count = int(os.environ.get("OCTOSKIN_HIL_POWER_CUTS", "3"))
    seed = int(os.environ.get("OCTOSKIN_HIL_SEED", random.SystemRandom().randrange(10_000)))
    if os.environ.get("OCTOSKIN_HIL") == "native":
        print("skipped: OCTOSKIN_HIL=native, but this machine's own power is not cut")
        return SKIPPED
    print(f"seed {seed}", flush=True)
    numbers = random.Random(seed)
    cuts = PowerCuts(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2])
    cuts.boot()
    for _ in range(count):
        told = cuts.cut_while_saving(numbers.uniform(0, SAVING_S))
        cuts.boot()
        cuts.check_after(told)
    machine("stop", cuts.folder)
    cuts.disk.unlink()
    shutil.rmtree(cuts.folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
