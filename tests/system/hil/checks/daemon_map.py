#!/usr/bin/env python3
"""Recorded traffic, played by canplayer, becomes the daemon's map, and a second daemon that records has the same frames and the
same map. What they accept and refuse is what `octoskin replay` accepts and refuses of the recorded log, to the last reading: also
if the emulated processor, or its host, was so busy that frames came late."""
import itertools
import json
import subprocess
import time

import daemon_bench
from daemon_bench import CAN, OCTOSKIN, RECORDING, claim, expect, frames_of


def account_of(replayed):
    """`readings 717 in = 271 used + 446 rejected`, and the rows below it, of what octoskin replay prints."""
    lines = iter(replayed.splitlines())
    heads = (line.split() for line in lines)
    taken, used = next((int(head[1]), int(head[4])) for head in heads if head[0] == "readings")
    rejected = {}
    for line in lines:
        if not line.startswith("  "):
            return {"in": taken, "used": used, "rejected": rejected}
        name, count = line.split()
        rejected[name] = int(count)
    raise ValueError(replayed)


def account_in(status):
    return {key: status["inputs"]["readings"][key] for key in ("in", "used", "rejected")}


def check(bench):
    log = frames_of(RECORDING / "can.log")
    mapper, recorder = bench.daemon("mapper", "--listen-only"), bench.daemon("recorder", "--listen-only")
    mapper.await_start()
    recorder.await_start()
    expect("voxels of an empty bus", 0, mapper.status()["map"]["known_voxels"])
    recorded = bench.folder / "recorded"
    recording = bench.start(OCTOSKIN, "record", recorded, "--socket", recorder.socket)
    recorder.await_status("the recording", lambda status: (status["recording"] or {}).get("state") == "recording")
    listener = bench.listener()

    playing = bench.start_playing(RECORDING / "can.log")
    during = []
    while playing.poll() is None:
        during.append(mapper.status())
        time.sleep(0.1)
    expect("exit code of canplayer", 0, playing.returncode)
    for daemon in (mapper, recorder):
        daemon.await_frames(len(log))
    after = json.loads(subprocess.check_output([OCTOSKIN, "status", "--json", "--socket", mapper.socket]))
    recording.terminate()
    expect("exit code of octoskin record", 0, recording.wait(daemon_bench.PATIENCE_S))

    expect("frames on the bus", log, listener.stop())
    expect("frames recorded", log, frames_of(recorded / "can.log"))
    voxels = [status["map"]["known_voxels"] for status in during]
    # A reading may make a voxel unknown that lies just before its end. Such voxels are few.
    most = list(itertools.accumulate(voxels, max))
    claim(len(set(voxels)) > 1 and all(now >= 0.95 * before for now, before in zip(voxels, most)), f"a map that grows: {voxels}")
    late_s = bench.lateness(RECORDING / "can.log", listener.log)
    if late_s < 0.1:
        claim(any(status["problems"] == [] for status in during), f"no problems at work: {during[-1]['problems']}")
    else:
        print(f"this machine was too busy to play in time ({late_s:.2f} s late): whether a daemon at work has no problems is not judged")
    expect("state of the bus", "up", after["can"]["state"])
    expect("frames lost on the way", (0, 0, 0),
           (after["can"]["dropped_by_kernel"], after["can"]["malformed"], after["nodes"][0]["sensors"][0]["lost"]))
    claim(all(unit["balanced"] for unit in after["inputs"].values()), f"in = used + rejected: {after['inputs']}")

    mapper.await_status("silence is named", lambda status: daemon_bench.has_sentence(status, "'bench': lost"))

    replayed = bench.replay(recorded, "--by-capture-time", "--fused-only", "--out", bench.folder / "replayed")
    for daemon in (mapper, recorder):
        expect(f"readings of {daemon.folder.name}", account_of(replayed), account_in(daemon.status()))
        daemon.stop()
    own = (recorder.maps / "fused.ot").read_bytes()
    expect("the two daemons' maps are one", True, own == (mapper.maps / "fused.ot").read_bytes())
    bench.replay(recorded, "--fused-only")
    expect("the recording's map is the daemon's own", True, own == (recorded / "maps/fused.ot").read_bytes())
    print(f"{len(log)} frames, {account_in(after)}, {after['map']['known_voxels']} voxels")


daemon_bench.run(check)
