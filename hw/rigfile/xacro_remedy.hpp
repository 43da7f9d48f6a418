// What to do with a xacro file.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "hw/rigfile/shell_word.hpp"

namespace octoskin::rig {

/// A definition of xacro, which alone changes no element. Where it is used, an expression is left, `${...}`.
[[nodiscard]] inline bool is_xacro_definition(std::string_view tag) {
    return tag == "xacro:property" || tag == "xacro:arg";
}

/// The command that expands it: "arm.urdf.xacro" and "arm.xacro" become arm.urdf.
[[nodiscard]] inline std::string xacro_remedy(const std::filesystem::path& file) {
    std::filesystem::path expanded = file.filename();
    if (expanded.extension() == ".xacro") expanded.replace_extension();
    if (expanded.extension() == ".urdf") expanded.replace_extension();
    // Never the file itself, which the shell would empty first.
    expanded += file.extension() == ".xacro" ? ".urdf" : "_expanded.urdf";
    return fmt::format(
        "run `xacro {} > {}`, with the arguments that its xacro:arg elements want (NAME:=VALUE), and give {}",
        shell_word(file.string()), shell_word(expanded.string()), expanded.string());
}

}  // namespace octoskin::rig
