// The named configurations of the experiment.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

struct StudyConfiguration {
    std::string name;
    MappingConfig mapping;
    bool is_depth_noise_free = false;  ///< which of the two recordings it is made from
    std::string text;                  ///< what it is, for people
};

/// `paper`: the paper's equations on noisy depth. `paper_noise_free_robot_seen`: the same on noise-free depth
/// with the robot left in the image, which is what the paper's own figures suggest it did. `robust`: depth
/// filtered, and voted. Empty for any other name.
[[nodiscard]] std::optional<StudyConfiguration> study_configuration(std::string_view name);

/// Their names, in the order in which they are reported.
inline constexpr std::string_view kStudyConfigurations[] = {"paper", "paper_noise_free_robot_seen", "robust"};

}  // namespace octoskin
