#!/usr/bin/env python3
"""Error frames as an adapter's driver tells them, from a raw socket: the kernel brings them to the daemon, whose status names an
error-passive and a bus-off adapter, and takes it back by the adapter's word, or by traffic that proves it. <linux/can/error.h>."""
import socket
import struct

import daemon_bench
from daemon_bench import CAN, RECORDING, claim, expect, frames_of, is_link_named, is_link_up

CONTROLLER, BUS_OFF, RESTARTED = 0x004, 0x040, 0x100  # classes of error
RX_PASSIVE, TX_PASSIVE, ACTIVE = 0x10, 0x20, 0x40     # of a controller's, in byte 1
# An error frame is taken when it comes. The rest is for the emulated processor, which makes a socket, and answers in 0.05 s or more.
NAMED_S = daemon_bench.limit_s(1.0, 0.2)


def tell(classes, controller=0):
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as adapter:
        adapter.bind((CAN,))
        adapter.send(struct.pack("=IB3x8s", socket.CAN_ERR_FLAG | classes, 8, bytes([0, controller])))


def check(bench):
    daemon = bench.daemon("daemon", "--listen-only")
    daemon.await_start()
    daemon.await_status("a link that is up", is_link_up)
    told, took_s = 0, []

    def say(what, is_so, *error):
        nonlocal told
        tell(*error)
        told += 1
        took_s.append(daemon.await_status(what, is_so, NAMED_S))
        expect("error frames", told, daemon.status()["can"]["error_frames"])

    def is_passive(status):
        return is_link_named(status, "error_passive", "error-passive")

    def is_off(status):
        return is_link_named(status, "bus_off", "bus-off")

    say("the news of a passive transmitter", is_passive, CONTROLLER, TX_PASSIVE)
    say("an active controller", is_link_up, CONTROLLER, ACTIVE)
    say("the news of bus-off", is_off, BUS_OFF)
    say("a restarted controller", is_link_up, RESTARTED)
    expect("times bus-off", 1, daemon.status()["can"]["bus_off"])

    # Not every adapter says that it is back.
    say("the news of a passive receiver", is_passive, CONTROLLER, RX_PASSIVE)
    bench.play(bench.first_lines(RECORDING / "can.log", 50))
    daemon.await_status("an adapter that hears", is_link_up, NAMED_S)
    say("the news of bus-off again", is_off, BUS_OFF)
    bench.play_by_ourselves(RECORDING)
    daemon.await_frames(50 + len(frames_of(RECORDING / "can.log")))
    status = daemon.status()
    claim(is_link_up(status), f"after traffic: {status['can']}, {status['problems']}")
    expect("bus-off, lost, malformed", (2, 0, 0), tuple(status["can"][key] for key in ("bus_off", "dropped_by_kernel", "malformed")))
    claim(status["inputs"]["readings"]["used"] > 0, f"readings used: {status['inputs']['readings']}")
    daemon.stop()
    print(f"{told} error frames heard, each one named, after {max(took_s):.2f} s at most; afterwards {status['inputs']['readings']['used']} readings used")


daemon_bench.run(check)
