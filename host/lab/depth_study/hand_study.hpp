// How quickly a map follows a hand: a small box that appears before the camera, rests, moves and leaves.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/lab/depth_study/seen_study.hpp"

namespace octoskin::depth_study {

enum class HandPath : std::uint8_t {
    towards,   ///< along the optical axis, from 2.45 m on
    sideways,  ///< along the image's rows, at 2.25 m, across the image's middle
};
[[nodiscard]] std::string_view name_of(HandPath path) noexcept;

inline constexpr std::array kHandSpeeds_m_per_s{0.02, 0.05, 0.1, 0.2};

/// The hand's voxels are those with a point of it that a noise-free pixel sees.
struct HandFigures {
    Subject subject;
    HandPath path = HandPath::towards;
    double speed_m_per_s = 0.0;
    /// From the first frame that shows the hand to the first after which 90 % of its voxels are occupied.
    /// Empty: not within the 2 s that it rests.
    std::optional<double> appears_s = std::nullopt;
    /// While it moves, from the fifth frame on: voxels of each frame, summed.
    std::uint64_t voxels = 0;
    std::uint64_t occupied = 0;
    std::uint64_t free = 0;
    /// From the first frame without the hand to the first after which none of the voxels that were ever its
    /// own is occupied. Empty: not within 5 s.
    std::optional<double> leaves_s = std::nullopt;
};

/// The box, 8 cm x 8 cm and 3 cm deep, faces the camera; a model `hand` of the world is left out. For 1 s the
/// world is empty, for 2 s the box rests, then it moves up to 0.4 m and up to 3 s, then it is gone. The
/// camera is the part of the image round the path; its optical axis must be in the image (asserted). Errors:
/// as DepthMapper::take().
[[nodiscard]] Result<std::vector<HandFigures>, AppError> study_hand(const DepthCase& of);

}  // namespace octoskin::depth_study
