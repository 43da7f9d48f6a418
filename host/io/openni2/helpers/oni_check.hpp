// Whether an .oni file may be given to OpenNI2, whose player has buffers of fixed sizes and trusts the sizes
// and the order of the records that it reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace octoskin::openni2 {

struct OniFault {
    std::uintmax_t position = 0;  ///< of the record
    std::string what;             ///< for a person: what is wrong with it
};

/// Empty if OpenNI2 2.2 can play the file to its end without a step beyond its buffers: each record and each
/// frame is what OpenNI2's recorder writes. Its lossy compression of colours is not among that: the decoder
/// for it reads beyond its input. Calls `is_alive` for each record. Reads all of the file; memory for 8 bytes
/// a frame.
[[nodiscard]] std::optional<OniFault> fault_of(const std::filesystem::path& oni,
                                               const std::function<void()>& is_alive = {});

}  // namespace octoskin::openni2
