// What is in a folder and below it, to compare it before and after a command.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace octoskin {

/// Whether a file's bytes are compared, or its size and the time of its last change stand for them.
enum class Bytes : std::uint8_t { compared, trusted };

/// By path below `folder`, and "." for itself: kind, mode, owner, time of the last change, and of a file its
/// bytes or its size. Not how many names it has: one of them may go. Links are not followed.
[[nodiscard]] std::map<std::string, std::string> states_in(const std::filesystem::path& folder,
                                                           Bytes bytes = Bytes::compared);

}  // namespace octoskin
