// Checks whether an .oni file is safe for OpenNI2, whose player has buffers of fixed sizes and does not check
// the sizes and the order of the records.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace octoskin::openni2 {

struct OniFault {
    std::uintmax_t position = 0;  ///< of the record
    std::string what;             ///< for the user: the fault
};

/// Empty if OpenNI2 2.2 can play the file to its end without leaving its buffers: each record and each frame
/// has the form that OpenNI2's recorder writes. Its lossy compression of colours is refused: the decoder for
/// it reads beyond its input. Calls `is_alive` for each record. Reads the whole file; needs memory of 8 bytes
/// a frame.
[[nodiscard]] std::optional<OniFault> fault_of(const std::filesystem::path& oni,
                                               const std::function<void()>& is_alive = {});

}  // namespace octoskin::openni2
