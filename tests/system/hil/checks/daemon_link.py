#!/usr/bin/env python3
"""The link goes down and comes back, the interface goes away and comes back: within two seconds the status names it, and has it back
by itself, in a daemon that sends SYNC and in one that only listens. Afterwards no frame is missing."""
import subprocess
import time

import daemon_bench
from daemon_bench import CAN, RECORDING, claim, expect, frames_of, is_link_named, is_link_up

NAMED_S = RECOVERED_S = 2.0


def ip(*arguments):
    subprocess.run(["ip", "link", *arguments], check=True)


def make_interface():
    subprocess.run(["ip", "link", "add", "dev", CAN, "type", "vcan"], check=False, stderr=subprocess.DEVNULL)
    ip("set", CAN, "mtu", "72", "txqueuelen", "1000")
    ip("set", "up", CAN)


def is_named(status, state, why):
    return is_link_named(status, state, why, subject=CAN)


def check(bench):
    bench.ended_with_us.callback(make_interface)
    listening, sending = bench.daemon("listening", "--listen-only"), bench.daemon("sending")
    took_s = {}

    def await_all(what, is_so, seconds):
        """Longest of all daemons, in seconds since now; whoever waits for his turn to be asked was not late."""
        began = time.monotonic()
        for daemon in (listening, sending):
            daemon.await_status(f"{what} ({daemon.folder.name})", is_so)
        took_s[what] = time.monotonic() - began
        claim(took_s[what] <= seconds, f"{what} took {took_s[what]:.2f} s")

    for daemon in (listening, sending):
        daemon.await_start()
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
    claim(after["account"]["readings"]["used"] > before["account"]["readings"]["used"], f"readings used: {after['account']}")
    listening.stop()
    print(", ".join(f"{what} after {seconds:.2f} s" for what, seconds in took_s.items()))


daemon_bench.run(check)
