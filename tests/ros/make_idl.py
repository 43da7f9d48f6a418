#!/usr/bin/env python3
"""Writes the IDL of all types in fields/, as ROS 2 maps messages to DDS, for fastddsgen -cs.

usage: make_idl.py OUT.idl

A message `package/Name` is the struct `package::msg::dds_::Name_`, its members have `_` behind their names. The
alternative without `-cs` fails: IDL compares names without case, so `Range_` collides with its member `range_`.
"""
import pathlib
import sys

import type_hashes

IDL_TYPES = {"bool": "boolean", "byte": "octet", "string": "string", "float32": "float", "float64": "double",
             "int8": "int8", "uint8": "octet", "int16": "short", "uint16": "unsigned short", "int32": "long",
             "uint32": "unsigned long", "int64": "long long", "uint64": "unsigned long long"}


def idl_name(name):
    package, message = name.split("/")
    return f"{package}::msg::dds_::{message}_"


def member(field):
    single = idl_name(field.type) if field.is_nested() else IDL_TYPES[field.type]
    if field.kind == "sequence":
        return f"sequence<{single}> {field.name}_;"
    if field.kind == "bounded":
        return f"sequence<{single}, {field.size}> {field.name}_;"
    if field.kind == "array":
        return f"{single} {field.name}_[{field.size}];"
    return f"{single} {field.name}_;"


def in_order(types):
    """Names of the types, each after those that it contains: these contain fewer types than it does."""
    return sorted(types, key=lambda name: (len(type_hashes.referenced(types, name)), name))


def struct(name, fields):
    package, message = name.split("/")
    members = "".join(f"    {member(field)}\n" for field in fields)
    modules = f"module {package} {{ module msg {{ module dds_ {{"
    return f"{modules}\n@final\nstruct {message}_ {{\n{members}}};\n}}; }}; }};\n"


def idl(types):
    return "\n".join(struct(name, types[name]) for name in in_order(types))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    pathlib.Path(sys.argv[1]).write_text(idl(type_hashes.read_types()))
