#!/usr/bin/env python3
"""The link goes down and comes back, the interface goes away and comes back: within a second the status names it, and has it back
by itself, in a daemon that only listens on a bus where nobody sends, and in two, of which one sends SYNC. Afterwards no frame is
missing."""
import subprocess
import time

import daemon_bench
from daemon_bench import CAN, RECORDING, claim, expect, frames_of, is_link_named, is_link_up

# A fault is told by the kernel at once; what is gone is asked for each 0.2 s, and attended to each 0.05 s. The rest is for the
# emulated processor, which starts `ip` meanwhile and answers each daemon in 0.05 s or more.
NAMED_S = RECOVERED_S = daemon_bench.limit_s(1.0, 0.2)


def ip(*arguments):
    subprocess.run(["ip", "link", *arguments], check=True)


def make_interface():
    subprocess.run(["ip", "link", "add", "dev", CAN, "type", "vcan"], check=False, stderr=subprocess.DEVNULL)
    ip("set", CAN, "mtu", "72", "txqueuelen", "1000")
    ip("set", "up", CAN)


def is_named(status, state, why):
    return is_link_named(status, state, why, subject=CAN)


def go_away_and_come_back(daemons, took_s):
    """`took_s`: gets what each news took, of all daemons, in seconds; whoever waits for his turn to be asked was not late."""
    def await_all(what, is_so, seconds):
        began = time.monotonic()
        for daemon in daemons:
            daemon.await_status(f"{what} ({daemon.folder.name})", is_so)
        took_s.append((f"{what} ({' and '.join(daemon.folder.name for daemon in daemons)})", time.monotonic() - began))
        claim(took_s[-1][1] <= seconds, f"{what} took {took_s[-1][1]:.2f} s")

    await_all("a link that is up", is_link_up, daemon_bench.PATIENCE_S)
    ip("set", "down", CAN)
    await_all("news of the link", lambda status: is_named(status, "down", "down"), NAMED_S)
    time.sleep(1)  # it stays so
    await_all("the link is still down", lambda status: is_named(status, "down", "down"), NAMED_S)
    ip("set", "up", CAN)
    await_all("the link again", is_link_up, RECOVERED_S)

    ip("del", CAN)
    await_all("news of the interface", lambda status: is_named(status, "absent", "No such device"), NAMED_S)
    make_interface()
    await_all("the interface again", is_link_up, RECOVERED_S)


def check(bench):
    bench.ended_with_us.callback(make_interface)
    took_s = []
    listening = bench.daemon("listening", "--listen-only")
    listening.await_start()
    go_away_and_come_back([listening], took_s)
    expect("frames on the bus by then", 0, listening.status()["can"]["received"])
    sending = bench.daemon("sending")
    sending.await_start()
    go_away_and_come_back([listening, sending], took_s)

    for daemon in (listening, sending):
        counts = daemon.status()["can"]
        claim(counts["went_down"] >= 1 and counts["reopened"] >= 1, f"the counts of {daemon.folder.name}: {counts}")
    claim(sending.status()["can"]["sent"] > 0, "SYNC was sent again")
    sending.stop()
    before = listening.status()
    bench.play(RECORDING / "can.log")
    listening.await_frames(before["can"]["received"] + len(frames_of(RECORDING / "can.log")))
    after = listening.status()
    expect("frames since", len(frames_of(RECORDING / "can.log")), after["can"]["received"] - before["can"]["received"])
    claim(after["inputs"]["readings"]["used"] > before["inputs"]["readings"]["used"], f"readings used: {after['inputs']}")
    listening.stop()
    print(", ".join(f"{what} after {seconds:.2f} s" for what, seconds in took_s))


daemon_bench.run(check)
