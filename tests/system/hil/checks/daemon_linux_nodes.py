#!/usr/bin/env python3
"""All sensors of a rig to one map: two Linux nodes with four sensors each, one that waits for data-ready lines and one that asks, an
arm at rest, and the daemon whose SYNC both follow. Each node's ranges in the status are what its sensors truly see; the second node's
beams come onto the map beside the first one's, whose readings go on."""
import time

import daemon_bench
from daemon_bench import claim, expect
from linux_node_bench import PATIENCE_S, RIG, TRUE_RANGE_M, OnMap, keep_arm_at_rest, start_node, used, wrong_ranges

BOARDS = ("first", "second")
RESOLUTION_M = 0.04
READINGS = 20  # more of them on the map, after each node's start


def check(bench):
    daemon = bench.daemon("daemon", rig=RIG)
    daemon.await_start()
    keep_arm_at_rest(bench)
    nodes, known = [], []
    for count, board in enumerate(BOARDS, 1):
        nodes.append(start_node(bench, board))
        before, are_on_map = used(daemon.status(), "readings"), OnMap(BOARDS[:count])

        def has_all(status):
            time.sleep(0.5)  # asking costs the nodes time
            return are_on_map(status) and used(status, "readings") >= before + READINGS
        try:
            daemon.await_status(f"the readings of {count} nodes on the map", has_all, PATIENCE_S)
        except daemon_bench.CheckFailed:
            print(daemon.account(), *daemon.status()["nodes"], sep="\n")
            raise
        status = daemon.status()
        expect("wrong ranges", [], [wrong for board in BOARDS[:count] for wrong in wrong_ranges(status, board)])
        known.append(status["map"]["known_voxels"])
    # A beam of length l leads through l / resolution voxels at least, but for those that another one has near the flange.
    beams = [sum(int(range_m / RESOLUTION_M) - 2 for range_m in TRUE_RANGE_M[board].values()) for board in BOARDS]
    claim(known[0] >= beams[0] and known[1] - known[0] >= beams[1], f"voxels of one node and of both: {known}, wanted {beams} and more")
    expect("frames not sent, lost", (0, 0), (status["can"]["not_sent"], status["can"]["dropped_by_kernel"]))
    for node in nodes:
        node.terminate()
        expect("exit code of a node", 0, node.wait(daemon_bench.PATIENCE_S))
    daemon.stop()
    print(f"{status['inputs']['readings']}, {known[0]} voxels of one node, {known[1]} of both")


daemon_bench.run(check)
