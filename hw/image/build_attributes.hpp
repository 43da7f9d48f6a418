// The target of a program, from its `.ARM.attributes` section. ARM IHI 0045, "Addenda to, and errata in, the
// ABI for the Arm architecture", "Build attributes".
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

namespace octoskin::image {

/// Tags of the public ("aeabi") attributes that the image check uses.
enum class BuildTag : std::uint32_t {
    cpu_architecture = 6,
    fp_architecture = 10,
    fp_use = 27,
    vfp_arguments = 28,
};

/// Values of these tags for the board's processor.
inline constexpr std::uint32_t kArchitectureV7eM = 13;
inline constexpr std::uint32_t kFpV4D16 = 6;
inline constexpr std::uint32_t kSinglePrecisionOnly = 1;
inline constexpr std::uint32_t kArgumentsInVfpRegisters = 1;

/// The value of each public attribute of the whole file; a missing tag has the value 0. Empty if the section
/// is malformed or has no public attributes.
[[nodiscard]] std::optional<std::map<std::uint32_t, std::uint32_t>> build_attributes(
    std::span<const std::uint8_t> section);

}  // namespace octoskin::image
