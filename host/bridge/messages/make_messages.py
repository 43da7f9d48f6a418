#!/usr/bin/env python3
"""Makes C++ structs of ROS 2 messages, with their type hashes: make_messages.py messages.txt ros_messages.hpp

A type hash (RIHS01, REP-2011) is the SHA-256 of a JSON text that lists a type's fields and those of all types in it.
"""
import hashlib
import json
import pathlib
import re
import sys
from dataclasses import dataclass, field

CPP = {"bool": "bool", "byte": "std::uint8_t", "int8": "std::int8_t", "uint8": "std::uint8_t",
       "int16": "std::int16_t", "uint16": "std::uint16_t", "int32": "std::int32_t", "uint32": "std::uint32_t",
       "int64": "std::int64_t", "uint64": "std::uint64_t", "float32": "float", "float64": "double",
       "string": "std::string"}
# Of type_description_interfaces/FieldType.
ID = {"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9, "float32": 10,
      "float64": 11, "bool": 15, "byte": 16, "string": 17}
NESTED, ARRAY, BOUNDED, UNBOUNDED = 1, 48, 96, 144


@dataclass
class Field:
    name: str
    base: str
    length: str  # "", "[]", "[N]" or "[<=N]"

    def number(self):
        return int(re.sub(r"\D", "", self.length) or 0)

    def cpp(self):
        one = CPP.get(self.base) or self.base.replace("/", "::")
        if not self.length:
            return one
        if self.length[1].isdigit():
            return f"std::array<{one}, {self.number()}>"
        # std::vector<bool> has no bytes.
        return f"std::vector<{'std::uint8_t' if one == 'bool' else one}>"

    def default(self):
        is_number = not self.length and self.base in CPP and self.base != "string"
        return "{}" if not is_number else " = false" if self.base == "bool" else " = 0"

    def description(self):
        kind = 0 if not self.length else UNBOUNDED if self.length == "[]" else \
            BOUNDED if "<" in self.length else ARRAY
        nested = "" if self.base in ID else wire_name(self.base)
        return {"name": self.name, "type": {
            "type_id": kind + ID.get(self.base, NESTED), "capacity": self.number(), "string_capacity": 0,
            "nested_type_name": nested}}


@dataclass
class Message:
    name: str
    fields: list = field(default_factory=list)
    constants: list = field(default_factory=list)


def wire_name(name):
    return name.replace("/", "/msg/")


def read(path):
    messages = {}
    message = None
    for number, line in enumerate(pathlib.Path(path).read_text(encoding="utf-8").splitlines(), 1):
        line = line.split("#")[0].rstrip()
        if not line:
            continue
        if not line[0].isspace():
            message = messages.setdefault(line, Message(line))
            continue
        match = re.fullmatch(r"\s+([\w/]+)((?:\[(?:<=)?\d*\])?) (\w+)(?: = (\d+))?", line)
        if not match:
            sys.exit(f"{path}:{number}: no field: {line}")
        base, length, name, value = match.groups()
        if base not in CPP and base not in messages:
            sys.exit(f"{path}:{number}: unknown type {base}")
        if value:
            message.constants.append((CPP[base], name, value, base))
        else:
            message.fields.append(Field(name, base, length))
    return messages


def description(message):
    return {"type_name": wire_name(message.name), "fields": [one.description() for one in message.fields]}


def types_in(message, messages, found=None):
    found = set() if found is None else found
    for one in message.fields:
        if one.base in messages and one.base not in found:
            found.add(one.base)
            types_in(messages[one.base], messages, found)
    return sorted(found, key=wire_name)


def type_hash(message, messages):
    text = json.dumps({"type_description": description(message), "referenced_type_descriptions":
                       [description(messages[name]) for name in types_in(message, messages)]})
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


def definition(message, messages):
    """The text of a schema of encoding ros2msg: https://mcap.dev/spec/registry#ros2msg"""
    parts = [message] + [messages[name] for name in types_in(message, messages)]
    texts = []
    for part in parts:
        lines = [] if part is message else ["=" * 80, f"MSG: {part.name}"]
        lines += [f"{ros} {name}={value}" for _, name, value, ros in part.constants]
        lines += [f"{one.base}{one.length} {one.name}" for one in part.fields]
        texts.append("\n".join(lines) + "\n")
    return "".join(texts)


def constant_name(name):
    return "k" + "".join(part.capitalize() for part in name.split("_"))


def struct(message, messages):
    package, name = message.name.split("/")
    lines = [f"namespace {package} {{", f"struct {name} {{"]
    lines += [f"    static constexpr {cpp} {constant_name(constant)} = {value};"
              for cpp, constant, value, _ in message.constants]
    lines += [f"    {one.cpp()} {one.name}{one.default()};" for one in message.fields]
    names = ", ".join(one.name for one in message.fields)
    lines += [
        "",
        f"    static constexpr TypeName kType{{\"{package}::msg::dds_::{name}_\",",
        f"        \"{type_hash(message, messages)}\", \"{wire_name(message.name)}\",",
        f"        R\"msg({definition(message, messages)})msg\"}};",
        f"    [[nodiscard]] auto all_fields() noexcept {{ return std::tie({names}); }}",
        f"    [[nodiscard]] auto all_fields() const noexcept {{ return std::tie({names}); }}",
        "};",
        f"}}  // namespace {package}",
        ""]
    return lines


def main():
    messages = read(sys.argv[1])
    lines = ["// Made by make_messages.py of messages.txt.", "#pragma once", "", "#include <array>",
             "#include <cstdint>", "#include <string>", "#include <tuple>", "#include <vector>", "",
             '#include "host/bridge/messages/type_name.hpp"', "", "namespace octoskin::ros {", ""]
    for message in messages.values():
        lines += struct(message, messages)
    lines += ["}  // namespace octoskin::ros", ""]
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        out.write("\n".join(lines))


if __name__ == "__main__":
    main()
