#!/usr/bin/env python3
"""The load that octoskin-bridge is, and the images that it loses: the README.md of this folder.

usage: bridge_figures.py FOLDER_OF_PROGRAMS [--figure NAME]... [--runs N] [--seconds S] [--bridge PROGRAM]
"""
import argparse
import json
import os
import pathlib
import socket
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "ros"))
import bridge_test  # noqa: E402
from bridge_world import World  # noqa: E402
from programs import DOMAIN, Programs, wait_for  # noqa: E402

BINARY, SCENE = "/octoskin/octomap_binary", "/planning_scene"
TYPES = {BINARY: "octomap_msgs/Octomap", SCENE: "moveit_msgs/PlanningScene"}
IMAGES = "/camera/depth/image_rect_raw"
LATE = ("--durability", "transient_local")


def cpu_seconds(pid):
    """User and system time of all threads."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def busy_share():
    """A function that returns how busy the machine's processors were since the call before, 0 to 1."""
    def read():
        values = [int(value) for value in pathlib.Path("/proc/stat").read_text().split("\n")[0].split()[1:9]]
        return sum(values), values[3] + values[4]
    state = [read()]

    def share():
        before, state[0] = state[0], read()
        return 1 - (state[0][1] - before[1]) / max(state[0][0] - before[0], 1)
    return share


class Figures:
    def __init__(self, arguments, folder):
        self.bin, self.seconds, self.folder = pathlib.Path(arguments.programs), arguments.seconds, folder
        self.bridge = arguments.bridge or self.bin / "octoskin-bridge"
        self.programs = Programs(self.bin)
        self.environment = {**os.environ, "ROS_DOMAIN_ID": str(DOMAIN)}
        (folder / "rig.yaml").write_text(bridge_test.RIG)
        with World(self.bin, rig=folder / "rig.yaml", is_mapped=False, daemon_options=[]) as world:
            (folder / "describe.json").write_text(json.dumps(world.ask("describe")))

    def start(self, *command):
        name = pathlib.Path(command[0]).name
        with open(self.folder / f"{name}.log", "w") as log, open(self.folder / f"{name}.out", "w") as out:
            return subprocess.Popen(list(map(str, command)), env=self.environment, stdout=out, stderr=log)

    def printed(self, program, kind):
        lines = map(json.loads, (self.folder / f"{program}.out").read_text().splitlines())
        return [line for line in lines if line["event"] == kind]

    def start_source(self, *options):
        source = self.start(self.bin / "watch_source", self.folder / "control", self.folder / "describe.json", *options)
        assert wait_for(lambda: (self.folder / "control").exists())
        return source

    def start_bridge(self):
        bridge = self.start(self.bridge, "run", "--socket", self.folder / "control", "--joints", self.folder / "joints",
                            "--status-socket", self.folder / "bridge")
        assert wait_for(lambda: (self.folder / "bridge").exists())
        assert wait_for(lambda: self.status()["daemon"]["connected"])
        return bridge

    def status(self):
        with socket.socket(socket.AF_UNIX) as asked:
            asked.connect(str(self.folder / "bridge"))
            asked.sendall(b"status\n")
            return json.loads(asked.makefile().readline())

    def end(self, *processes):
        for process in processes:
            process.terminate()
            process.wait()
        for name in ("control", "bridge"):
            (self.folder / name).unlink(missing_ok=True)

    def load(self, publisher, topics):
        """The publisher's processor time in percent of a core while the topics are read."""
        readers = [self.programs.start_listening("--quiet", "--seconds", self.seconds + 60, *LATE, topic, TYPES[topic])
                   for topic in topics]
        assert all(wait_for(lambda: reader.events("matched"), 20) for reader in readers)
        time.sleep(3)
        share, begun, cpu = busy_share(), time.monotonic(), cpu_seconds(publisher.pid)
        sent = self.sent(topics)
        time.sleep(self.seconds)
        lasted, cpu = time.monotonic() - begun, cpu_seconds(publisher.pid) - cpu
        figures = {"cpu_percent": round(100 * cpu / lasted, 2), "machine_busy": round(share(), 2),
                   "load": os.getloadavg()[0]}
        sent = [after - before for after, before in zip(self.sent(topics), sent)]
        for reader, topic, count in zip(readers, topics, sent):
            got = reader.stop("counts")[0]["topics"][topic]
            reader.__exit__()
            figures[topic] = {"sent_hz": round(count / lasted, 2), "samples": got["samples"], "lost": got["lost"],
                              "kib": got["bytes"] // max(got["samples"], 1) // 1024, "latency_ms": got["latency_ms"]}
        return figures

    def sent(self, topics):
        if not (self.folder / "bridge").exists():
            return [0] * len(topics)
        sent = {topic["topic"]: topic["sent"] for topic in self.status()["topics"]}
        return [sent[topic] for topic in topics]

    def transport(self):
        """1 MiB ten times a second, without any encoding."""
        publisher = self.start(self.bin / "fixed_messages")
        figures = self.load(publisher, [BINARY])
        self.end(publisher)
        return figures

    def of_map(self, topics, *options):
        source = self.start_source(*options)
        bridge = self.start_bridge()
        time.sleep(2)
        figures = self.load(bridge, topics)
        self.end(bridge, source)
        return {**figures, "map": self.printed("watch_source", "map")[0]}

    def mebibyte(self):
        """A map of 1 MiB that changes ten times a second."""
        return self.of_map([BINARY], "--occupied", 560_000, "--rate", 10)

    def changes(self):
        """300,000 occupied voxels, both topics, five times a second."""
        return self.of_map([BINARY, SCENE], "--occupied", 300_000, "--rate", 5)

    def changes_10_hz(self):
        return self.of_map([BINARY, SCENE], "--occupied", 300_000, "--rate", 10)

    def unread(self):
        """The changes without readers."""
        return self.of_map([], "--occupied", 300_000, "--rate", 5)

    def idle(self):
        """No readers, and a map that stays."""
        return self.of_map([], "--occupied", 10_000, "--rate", 1, "--share", 0)

    def images(self, qos):
        source = self.start_source("--occupied", 1000, "--rate", 1)
        bridge = self.start_bridge()
        camera = lambda: self.status()["cameras"][0]
        with self.programs.start_saying([bridge_test.info_line()], "--linger", 60):
            share, cpu, begun = busy_share(), cpu_seconds(bridge.pid), time.monotonic()
            said = self.programs.run("ros_say", "--images", "640x480", "--rate", 30, "--count", 300, "--stamp-now",
                                     "--topic", IMAGES, "--qos", qos, "--settle", 1, "--linger", 2, "--until-read")
            lasted, cpu = time.monotonic() - begun, cpu_seconds(bridge.pid) - cpu
            assert said.returncode == 0, said.stderr
            counts = camera()
        self.end(bridge)
        assert wait_for(lambda: self.printed("watch_source", "images"))
        arrived = self.printed("watch_source", "images")[0]
        self.end(source)
        return {"cpu_percent": round(100 * cpu / lasted, 2), "machine_busy": round(share(), 2),
                "load": os.getloadavg()[0], "arrived": arrived["count"],
                "arrived_first_last": [arrived["numbers"][0], arrived["numbers"][-1]],
                "latency_ms": arrived["latency_ms"], "received": counts["received"], "lost": counts["lost"],
                "forwarded": counts["forwarded"], "sent": counts["sent"], "displaced": counts["displaced"],
                "behind": counts["behind"], "no_camera_info": counts["no_camera_info"]}

    def images_reliable(self):
        return self.images("reliable")

    def images_best_effort(self):
        return self.images("best_effort")


ALL = ["idle", "unread", "transport", "mebibyte", "changes", "changes_10_hz", "images_reliable", "images_best_effort"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("--figure", action="append", choices=ALL)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--bridge", help="another build of octoskin-bridge")
    arguments = parser.parse_args()
    for name in arguments.figure or ALL:
        cpu = []
        for _ in range(arguments.runs):
            with tempfile.TemporaryDirectory() as folder:
                figures = getattr(Figures(arguments, pathlib.Path(folder)), name)()
            print(json.dumps({"figure": name, **figures}), flush=True)
            cpu.append(figures["cpu_percent"])
        print(f"{name}: {min(cpu)} % of a core at least, {statistics.median(cpu)} % in the median", flush=True)


if __name__ == "__main__":
    main()
