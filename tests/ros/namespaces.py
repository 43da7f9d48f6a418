#!/usr/bin/env python3
"""Two machines joined by a cable, on one: network namespaces with a veth pair. Needs root.

usage: namespaces.py COMMAND_ONE COMMAND_TWO

Runs a shell command in each, at the same time, until both have ended; the first has the address 10.77.0.1, the second
10.77.0.2, and nothing else is reachable. Then prints the packets of each end of the cable. Exit code 0 if both have 0.
"""
import json
import os
import shutil
import subprocess
import sys
import time

# Two programs on one machine could also talk through shared memory: each machine has its own.
PREPARE = "mount -t tmpfs tmpfs /dev/shm && ip link set lo up && hostname {name} && echo ready && exec cat"


class Machine:
    """Namespaces of a process that lives as long as this one: it ends when its standard input is closed."""

    def __init__(self, name, address=None):
        self.name, self.address = name, address
        self.holder = subprocess.Popen(
            ["unshare", "--net", "--ipc", "--mount", "--uts", "sh", "-c", PREPARE.format(name=name)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if self.holder.stdout.readline() != "ready\n":
            reason = self.holder.stderr.read().strip()
            self.end()
            raise RuntimeError(f"no namespaces: {reason}")
        # What comes before a command line to run it in the machine.
        self.prefix = ["nsenter", "--target", str(self.holder.pid), "--net", "--ipc", "--mount", "--uts", "--wd", "--"]

    def run(self, *command):
        """The output of a command. Raises CalledProcessError if it fails."""
        return subprocess.run([*self.prefix, *command], check=True, capture_output=True, text=True).stdout

    def counts(self):
        """Packets and bytes through this end of the cable: {"rx": {"packets": 1, "bytes": 2, ...}, "tx": ...}."""
        return json.loads(self.run("ip", "-s", "-j", "link", "show", "cable"))[0]["stats64"]

    def set_link(self, is_up):
        """Pulls or plugs this end. The other end then has no carrier."""
        self.run("ip", "link", "set", "cable", "up" if is_up else "down")

    def wait_until_up(self, seconds=5):
        """A DDS program that starts before both ends are up never uses the cable. Raises RuntimeError."""
        end = time.monotonic() + seconds
        while json.loads(self.run("ip", "-j", "link", "show", "cable"))[0]["operstate"] != "UP":
            if time.monotonic() > end:
                raise RuntimeError(f"the cable of '{self.name}' is not up after {seconds} s")
            time.sleep(0.01)

    def end(self):
        for pipe in (self.holder.stdin, self.holder.stdout, self.holder.stderr):
            pipe.close()
        self.holder.wait()


class TwoMachines:
    """`with TwoMachines() as (one, two):`; raises RuntimeError with the reason where it cannot be done."""

    def __init__(self):
        missing = [tool for tool in ("unshare", "nsenter", "ip", "mount") if shutil.which(tool) is None]
        if missing:
            raise RuntimeError("not installed: " + ", ".join(missing))
        self.machines = []

    def __enter__(self):
        try:
            self.machines.append(Machine("one", "10.77.0.1"))
            self.machines.append(Machine("two", "10.77.0.2"))
            self.join()
        except subprocess.CalledProcessError as error:
            self.__exit__()
            raise RuntimeError("no cable: " + error.stderr.strip()) from None
        except RuntimeError:
            self.__exit__()
            raise
        return self.machines

    def __exit__(self, *_):
        for machine in self.machines:
            machine.end()

    def join(self):
        one, two = self.machines
        one.run("ip", "link", "add", "cable", "type", "veth", "peer", "name", "cable", "netns", str(two.holder.pid))
        for machine in self.machines:
            machine.run("ip", "address", "add", machine.address + "/24", "dev", "cable")
            machine.set_link(True)
        for machine in self.machines:
            machine.wait_until_up()


def main(commands):
    with TwoMachines() as machines:
        running = [subprocess.Popen([*machine.prefix, "sh", "-c", command])
                   for machine, command in zip(machines, commands)]
        codes = [process.wait() for process in running]
        print(json.dumps({machine.name: machine.counts() for machine in machines}))
    return 0 if codes == [0, 0] else 1


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        sys.exit(main(sys.argv[1:]))
    except RuntimeError as error:
        sys.exit(f"{os.path.basename(__file__)}: {error}")
