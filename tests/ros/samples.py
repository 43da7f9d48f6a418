"""Messages with a value in every field, and their bytes by an encoder of its own: a second one beside fastddsgen's."""
import struct

import type_hashes

# struct's letter and the size, to which CDR aligns.
LETTERS = {"bool": "?", "byte": "B", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
           "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d"}
ENCAPSULATION = b"\x00\x01\x00\x00"  # CDR, little endian


class Values:
    """Values that differ from each other, so that two fields in each other's place are noticed."""

    def __init__(self):
        self.number = 0

    def single(self, kind):
        self.number += 1
        if kind == "string":
            return f"text {self.number}" + "x" * (self.number % 5)
        if kind == "bool":
            return self.number % 3 == 0
        if kind.startswith("float"):
            return self.number + 0.25
        return self.number % 100 if kind.endswith("8") or kind == "byte" else self.number

    def of_field(self, types, field, elements):
        def one():
            return self.message(types, field.type, elements) if field.is_nested() else self.single(field.type)
        if field.kind == "one":
            return one()
        count = field.size if field.kind == "array" else min(elements, field.size or elements)
        return [one() for _ in range(count)]

    def message(self, types, name, elements):
        return {field.name: self.of_field(types, field, elements) for field in types[name]}


def sample(types, name, elements=2):
    """A message, whose sequences have so many elements."""
    return Values().message(types, name, elements)


def aligned(data, size):
    return data + b"\0" * (-len(data) % size)


def append_single(data, kind, value):
    if kind == "string":
        text = value.encode() + b"\0"
        return append_single(data, "uint32", len(text)) + text
    size = struct.calcsize(LETTERS[kind])
    return aligned(data, size) + struct.pack("<" + LETTERS[kind], value)


def append_field(types, data, field, value):
    values = value
    if field.kind == "one":
        values = [value]
    elif field.kind != "array":
        data = append_single(data, "uint32", len(value))
    for element in values:
        if field.is_nested():
            data = append_message(types, data, field.type, element)
        else:
            data = append_single(data, field.type, element)
    return data


def append_message(types, data, name, values):
    for field in types[name]:
        data = append_field(types, data, field, values[field.name])
    return data


def cdr(types, name, values):
    """The bytes of a message as DDS carries them."""
    return ENCAPSULATION + append_message(types, b"", name, values)


def as_printed(types, name, values):
    """The fields as ros_listen --all-bytes prints them: sequences of bytes as their size and digits."""
    printed = {}
    for field in types[name]:
        value = values[field.name]
        if field.is_nested():
            printed[field.name] = (as_printed(types, field.type, value) if field.kind == "one" else
                                   [as_printed(types, field.type, element) for element in value])
        elif field.kind != "one" and field.type in ("byte", "int8", "uint8"):
            printed[field.name] = {"size": len(value), "hex": bytes(element % 256 for element in value).hex()}
        else:
            printed[field.name] = value
    return printed


def octree_key(position_m, resolution_m):
    """OctoMap's key of the voxel at a position."""
    return [int(value // resolution_m) + 32768 for value in position_m]


def binary_octree(position_m, resolution_m):
    """Octomap's binary data of a tree whose only voxel is occupied: two bits for each of a node's eight children,
    3 for an inner node, 2 for an occupied leaf, whose second bit is the higher one."""
    key = octree_key(position_m, resolution_m)
    data = b""
    for depth in range(16):
        child = sum(((key[axis] >> (15 - depth)) & 1) << axis for axis in range(3))
        data += struct.pack("<H", (3 if depth < 15 else 2) << (2 * child))
    return data


def full_octree(position_m, resolution_m, inner_log_odds, leaf_log_odds):
    """Octomap's full data of the same tree: each node's log-odds and a bit for each child that is there."""
    key = octree_key(position_m, resolution_m)
    data = b""
    for depth in range(16):
        child = sum(((key[axis] >> (15 - depth)) & 1) << axis for axis in range(3))
        data += struct.pack("<fB", inner_log_odds, 1 << child)
    return data + struct.pack("<fB", leaf_log_odds, 0)


ALL_TYPES = type_hashes.read_types()
