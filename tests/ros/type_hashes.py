#!/usr/bin/env python3
"""Field lists of ROS 2 messages and their type hashes RIHS01 (REP-2011).

usage: type_hashes.py          prints `TYPE HASH` of every type in fields/
"""
import hashlib
import json
import pathlib
import re

FIELDS = pathlib.Path(__file__).resolve().parent / "fields"

# REP-2011, type_description_interfaces/msg/FieldType: numbers of the single types. An array, a bounded and an unbounded
# sequence of a type have its number plus these.
TYPE_IDS = {"nested": 1, "int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8,
            "uint64": 9, "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17}
ARRAY, BOUNDED_SEQUENCE, SEQUENCE = 48, 96, 144

FIELD = re.compile(r"(?P<type>[A-Za-z0-9_/]+)(?P<many>\[(?P<bound><=)?(?P<size>\d*)\])? (?P<name>[a-z0-9_]+)")


class Field:
    """One field. `kind` is "one", "array", "bounded" or "sequence"; `size` counts the elements of the middle two."""

    def __init__(self, line):
        parts = FIELD.fullmatch(line)
        if parts is None:
            raise ValueError(f"no field: '{line}'")
        self.type, self.name = parts["type"], parts["name"]
        self.size = int(parts["size"] or 0)
        self.kind = "one"
        if parts["many"]:
            self.kind = "bounded" if parts["bound"] else "array" if parts["size"] else "sequence"
        if not self.is_nested() and self.type not in TYPE_IDS:
            raise ValueError(f"unknown type in '{line}'")

    def is_nested(self):
        return "/" in self.type


def read_types(folder=FIELDS):
    """All types of the field lists: `package/Name` -> list of Field."""
    types = {}
    for path in sorted(pathlib.Path(folder).glob("*.txt")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if not line or line.startswith("#"):
                continue
            try:
                if line.startswith(" "):
                    fields.append(Field(line.strip()))
                else:
                    fields = types[f"{path.stem}/{line}"] = []
            except ValueError as error:
                raise ValueError(f"{path}:{number}: {error}") from None
    for name, fields in types.items():
        for field in fields:
            if field.is_nested() and field.type not in types:
                raise ValueError(f"{name}.{field.name}: no field list of {field.type}")
    return types


def in_msg(name):
    """`package/Name` as ROS 2 writes it in a description: `package/msg/Name`."""
    return name.replace("/", "/msg/")


def field_description(field):
    offset = {"one": 0, "array": ARRAY, "bounded": BOUNDED_SEQUENCE, "sequence": SEQUENCE}[field.kind]
    single = TYPE_IDS["nested" if field.is_nested() else field.type]
    return {"name": field.name,
            "type": {"type_id": single + offset, "capacity": field.size, "string_capacity": 0,
                     "nested_type_name": in_msg(field.type) if field.is_nested() else ""}}


def type_description(types, name):
    return {"type_name": in_msg(name), "fields": [field_description(field) for field in types[name]]}


def referenced(types, name):
    """Names of all types in `name`, at any depth, without itself."""
    found, waiting = set(), [name]
    while waiting:
        for field in types[waiting.pop()]:
            if field.is_nested() and field.type not in found:
                found.add(field.type)
                waiting.append(field.type)
    return found


def type_hash(types, name):
    description = {"type_description": type_description(types, name),
                   "referenced_type_descriptions": [type_description(types, other) for other in
                                                    sorted(referenced(types, name), key=in_msg)]}
    text = json.dumps(description, separators=(", ", ": "))
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


if __name__ == "__main__":
    all_types = read_types()
    for type_name in sorted(all_types):
        print(in_msg(type_name), type_hash(all_types, type_name))
