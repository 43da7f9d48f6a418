"""What the checks of the daemon beside Linux nodes share: the nodes, an arm at rest, and what their sensors truly see."""
import contextlib
import os
import pathlib
import subprocess
import threading
import time

from daemon_bench import CAN, OCTOSKIN

RIG = pathlib.Path(__file__).resolve().parent.parent / "two_linux_boards_fd.yaml"
JOINT_NODE = 10
PATIENCE_S = 120  # each node has hundreds of transfers to make, on an emulated processor
# Each node's, in the rig's order: as board.sh says. Not those whose range moves, nor the one that sees nothing.
TRUE_RANGE_M = {"first": {0: 0.250, 1: 0.500}, "second": {0: 0.300, 2: 0.700, 3: 0.900}}


def start_node(bench, board):
    devices = {
        "first": ("--i2c", "/dev/i2c-7", "/dev/i2c-8", "--xshut", f"{os.environ['HIL_CHIP']}:0,1,2,3", "--uid",
                  "0102030405060708090a0b0c"),
        "second": ("--i2c", "/dev/i2c-9", "/dev/i2c-10", "--xshut", f"{os.environ['HIL_CHIP2']}:0,1,2,3", "--data-ready",
                   f"{os.environ['HIL_CHIP2']}:4,5", "--uid", "1112131415161718191a1b1c"),
    }[board]
    return bench.start(f"{os.environ['HIL_BIN']}/octoskin-node", "--config", f"{os.environ['HIL_BLOCKS']}/{board}.fd.block", "--can", CAN,
                       "--i2c-lateness-ms", "500", *devices)


def keep_arm_at_rest(bench):
    """A joint sample each 20 ms from the rig's joint node, until the check ends. It keeps the bus from falling silent, too, which a
    single node's heartbeats on a busy processor do not."""
    joints = bench.end_with_us(subprocess.Popen([OCTOSKIN, "joints", "--can", CAN, "--rig", RIG], stdin=subprocess.PIPE, text=True))

    def feed():
        with contextlib.suppress(OSError):  # it has ended
            while True:
                joints.stdin.write("0 0 0 -1.5 0 1.5 0\n")
                joints.stdin.flush()
                time.sleep(0.02)
    threading.Thread(target=feed, daemon=True).start()


def used(status, unit):
    return status["inputs"][unit]["used"]


def node_of(status, board):
    return status["nodes"][("first", "second").index(board)]


class OnMap:
    """Whether some boards are: each is usable, five readings of each of its sensors came, and of each that sees something at rest one
    was on the map when we looked."""

    def __init__(self, boards):
        self.boards = boards
        self.missing = {(board, sensor) for board in boards for sensor in TRUE_RANGE_M[board]}

    def __call__(self, status):
        nodes = {board: node_of(status, board) for board in self.boards}
        for board, number in list(self.missing):
            sensor = nodes[board]["sensors"][number]
            if sensor["received"] > 0 and sensor["rejected"] is None:
                self.missing.remove((board, number))
        return not self.missing and all(node["verdict"] == "usable" and all(sensor["received"] >= 5 for sensor in node["sensors"])
                                        for node in nodes.values())


def wrong_ranges(status, board):
    """Sentences; none if each sensor tells what it sees."""
    sensors = node_of(status, board)["sensors"]
    return [f"sensor {sensor} of {board}: {sensors[sensor]}, it sees {range_m} m" for sensor, range_m in TRUE_RANGE_M[board].items()
            if abs(sensors[sensor]["range_m"] - range_m) > 0.001]
