#include "host/apps/study/configuration.hpp"

namespace octoskin {

std::optional<StudyConfiguration> study_configuration(std::string_view name) {
    if (name == "paper") {
        return StudyConfiguration{"paper", paper_mapping(), false,
                                  "the paper's equations, 3 cm noise on every depth pixel"};
    }
    if (name == "paper_noise_free_robot_seen") {
        MappingConfig mapping = paper_mapping();
        mapping.removes_robot_from_depth = false;
        return StudyConfiguration{"paper_noise_free_robot_seen", mapping, true,
                                  "the paper's equations, depth without noise, the robot left in the image"};
    }
    if (name == "robust") {
        return StudyConfiguration{"robust", robust_mapping(), false,
                                  "depth filtered; a voxel's term is the mean of its beams'"};
    }
    return std::nullopt;
}

}  // namespace octoskin
