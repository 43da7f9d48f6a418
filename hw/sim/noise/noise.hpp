// Noise as a function of (seed, source, index): independent of other draws, their order and the number of
// threads.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace octoskin::sim {

/// Sources of noise. The numbers define the noise of a seed: never reuse one.
enum class NoiseSource : std::uint64_t {
    depth = 1,
    range = 2,
    map_shift = 3,
    signal = 4,
    depth_edge = 5,
    depth_bias = 6,
    further_camera = 7  ///< the seeds of the cameras of a rig after its first
};

/// A sequence of independent random numbers that can be read at any index, in O(1). Counter-based: Steele,
/// Lea and Flood 2014 (SplitMix64), whose output function is applied to a key plus a multiple of the golden
/// ratio.
class Noise {
  public:
    constexpr Noise(std::uint64_t seed, NoiseSource source) noexcept
        : key_(mixed(mixed(seed) + static_cast<std::uint64_t>(source))) {}

    /// The sequence of one sensor or one frame of this source.
    [[nodiscard]] constexpr Noise of(std::uint64_t member) const noexcept {
        return Noise(mixed(mixed(key_) + member));
    }

    [[nodiscard]] constexpr std::uint64_t bits(std::uint64_t index) const noexcept {
        return mixed(key_ + (index + 1) * kGoldenRatio);
    }
    /// Uniform in (0, 1), never 0 or 1.
    [[nodiscard]] constexpr double uniform(std::uint64_t index) const noexcept {
        return (static_cast<double>(bits(index) >> 12) + 0.5) * 0x1p-52;
    }
    /// Normal with mean 0 and deviation 1 (Box and Muller 1958), at most 6.8. About 20 ns.
    [[nodiscard]] double gaussian(std::uint64_t index) const noexcept {
        const std::uint64_t both = bits(index);
        const double radius_uniform = (static_cast<double>(both >> 32) + 0.5) * 0x1p-32;
        const double turn_uniform = static_cast<double>(both & 0xFFFFFFFFU) * 0x1p-32;
        return std::sqrt(-2.0 * std::log(radius_uniform)) * std::cos(2.0 * std::numbers::pi * turn_uniform);
    }

  private:
    static constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15;

    constexpr explicit Noise(std::uint64_t key) noexcept : key_(key) {}

    static constexpr std::uint64_t mixed(std::uint64_t z) noexcept {
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
        return z ^ (z >> 31);
    }

    std::uint64_t key_;
};

}  // namespace octoskin::sim
