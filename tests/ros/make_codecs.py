#!/usr/bin/env python3
"""Writes the C++ source that turns each message of fields/ into JSON and back: codecs() of codec.hpp.

usage: make_codecs.py OUT.cpp

The order and the types of the fields come from fastddsgen's classes; this source only names them.
"""
import pathlib
import sys

import make_idl
import type_hashes

HEAD = """// Written by make_codecs.py.
#include "ros_types.h"
#include "tests/ros/cdr.hpp"
#include "tests/ros/json_values.hpp"

namespace octoskin::ros {
"""

TAIL = """
template <typename Message>
Decoded decode(const Bytes& bytes, const Shown& shown) {
    const auto read = read_cdr<Message>(bytes);
    return {json_of(read.message, shown), read.unread};
}

template <typename Message>
Bytes encode(const Json& fields) {
    Message message;
    read_json(fields, message, {});
    return write_cdr(message);
}
"""


def functions(name, fields):
    cpp = "::" + make_idl.idl_name(name)
    shown = "".join(f'    json["{field.name}"] = json_of(value.{field.name}_(), shown);\n' for field in fields)
    names = ", ".join(f'"{field.name}"' for field in fields)
    read = "".join(f'    read_member(json, "{field.name}", value.{field.name}_(), place);\n' for field in fields)
    return (f"\nJson json_of(const {cpp}& value, const Shown& shown) {{\n    Json json;\n{shown}    return json;\n}}\n"
            f"\nvoid read_json(const Json& json, {cpp}& value, const Place& place) {{\n"
            f"    refuse_other_members(json, {{{names}}}, place);\n{read}}}\n")


def row(types, name):
    cpp = make_idl.idl_name(name)
    return (f'        {{"{name}", "{cpp}", "{type_hashes.type_hash(types, name)}",\n'
            f"         &decode<::{cpp}>, &encode<::{cpp}>}},\n")


def source(types):
    text = HEAD
    for name in make_idl.in_order(types):
        text += functions(name, types[name])
    text += TAIL + "\nconst std::vector<Codec>& codecs() {\n    static const std::vector<Codec> all = {\n"
    text += "".join(row(types, name) for name in sorted(types))
    return text + "    };\n    return all;\n}\n\n}  // namespace octoskin::ros\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    pathlib.Path(sys.argv[1]).write_text(source(type_hashes.read_types()))
