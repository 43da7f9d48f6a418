#!/usr/bin/env python3
"""OctoMap's files read without a line of our code: the header, then every node, to the last byte.
    map_file.py FILE...      prints the known voxels of each; exit code 1 if one is not whole"""
import pathlib
import struct
import sys

DEPTH = 16
INNER = 3  # .bt: two bits a child: 0 none, 1 occupied, 2 free, 3 inner


def header_and_data(path):
    header, data = pathlib.Path(path).read_bytes().split(b"\ndata\n", 1)
    lines = header.decode("ascii").splitlines()
    fields = dict(line.split(" ", 1) for line in lines if not line.startswith("#"))
    if fields["id"] != "OcTree":
        raise ValueError(f"{path}: id {fields['id']}")
    return int(fields["size"]), data


def full_children(node):
    """.ot, five bytes a node: its log-odds, and a bit for each child. A leaf is a voxel, or as many as are pruned into it."""
    log_odds, children = struct.unpack("<fB", node)
    if not -10.0 < log_odds < 10.0:
        raise ValueError(f"log-odds {log_odds}")
    return children.bit_count(), 0 if children else 1


def binary_children(node):
    """.bt, two bytes an inner node; leaves have none of their own."""
    bits = int.from_bytes(node, "little")
    kinds = [bits >> shift & 3 for shift in range(0, 16, 2)]
    return kinds.count(INNER), sum(0 < kind < INNER for kind in kinds)


def known_voxels(path):
    """Of a whole map; ValueError, saying why, of any other file."""
    is_full = pathlib.Path(path).suffix == ".ot"
    size, data = header_and_data(path)
    step, children_of = (5, full_children) if is_full else (2, binary_children)
    nodes = leaves = known = place = 0
    waiting = [0] if size else []  # depths of the nodes that must follow, the next one last
    while waiting:
        depth = waiting.pop()
        node = data[place:place + step]
        if len(node) < step or depth > DEPTH:
            raise ValueError(f"{path}: ends within node {nodes}, or is too deep there")
        inner, here = children_of(node)
        waiting += [depth + 1] * inner
        nodes, leaves, place = nodes + 1, leaves + here, place + step
        known += here * 8 ** (DEPTH - depth if is_full else DEPTH - depth - 1)
    if place != len(data) or size != (nodes if is_full else nodes + leaves):
        raise ValueError(f"{path}: {len(data)} bytes for {nodes} nodes, {size} promised")
    return known


def write_cube(path, levels):
    """A map of 8 ** levels voxels in a cube, occupied and free by turns, so that nothing is pruned: the file takes its time."""
    def subtree(level):
        if level == levels:
            return b"".join(struct.pack("<fB", log_odds, 0) for log_odds in (0.85, -0.4) * 4)
        return (struct.pack("<fB", 0.85, 0xFF) + subtree(level + 1)) * 8
    path_down = struct.pack("<fB", 0.85, 1) * (DEPTH - levels)
    nodes = path_down + struct.pack("<fB", 0.85, 0xFF) + subtree(1)
    header = f"# Octomap OcTree file\nid OcTree\nsize {len(nodes) // 5}\nres 0.04\ndata\n"
    pathlib.Path(path).write_bytes(header.encode() + nodes)


if __name__ == "__main__":
    try:
        print(*(known_voxels(path) for path in sys.argv[1:]))
    except (ValueError, OSError, KeyError) as error:
        sys.exit(f"not a whole map: {error}")
