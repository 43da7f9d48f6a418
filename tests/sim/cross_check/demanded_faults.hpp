// Of which sensors a fault must be found in thirty seconds of the experiment: those of which the evidence,
// had their ranges no noise, reached twice what names a sensor when a range was compared wherever the image
// had a value. The list stays as it is, so that a comparison that finds less cannot ask for less.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace octoskin::testing_support {

enum class FaultKind { too_long, too_short, every_third_short, turned, exchanged };

struct DemandedFault {
    std::string_view rig;
    FaultKind kind;
    std::size_t which;  ///< of a turn, which way; of an exchange, so many sensors further on the node
    std::vector<std::size_t> sensors;
};

inline const std::vector<DemandedFault> kDemandedFaults = {
    {"experiment.yaml", FaultKind::too_long, 0, {0, 1, 7, 8, 16, 17, 26, 28, 30, 31, 33}},
    {"experiment.yaml", FaultKind::too_short, 0, {0, 1, 7, 8, 16, 17, 18, 26, 28, 30, 31, 33}},
    {"experiment.yaml", FaultKind::every_third_short, 0, {0, 1, 7, 8, 16, 17}},
    {"experiment.yaml", FaultKind::turned, 0, {0, 8, 16, 26, 28, 31, 33}},
    {"experiment.yaml", FaultKind::turned, 1, {0, 1, 7, 8, 18, 25, 26, 31, 33}},
    {"experiment.yaml", FaultKind::turned, 2, {8, 18, 25, 26, 33}},
    {"experiment.yaml", FaultKind::turned, 3, {0, 1, 7, 17, 18, 26, 33}},
    {"experiment.yaml", FaultKind::turned, 4, {0, 1, 7, 17, 25, 26, 33}},
    {"experiment.yaml", FaultKind::turned, 5, {0, 1, 7, 17, 25, 26, 33}},
    {"experiment.yaml", FaultKind::turned, 6, {16, 18, 25, 26, 33}},
    {"experiment.yaml", FaultKind::turned, 7, {0, 1, 16, 18, 25, 26, 31, 33}},
    {"experiment.yaml", FaultKind::exchanged, 1, {0, 8, 16, 17, 18, 26, 33}},
    {"experiment.yaml", FaultKind::exchanged, 8, {0, 16, 17, 26}},
    {"experiment_cone.yaml", FaultKind::too_long, 0, {8, 16, 30}},
    {"experiment_cone.yaml", FaultKind::too_short, 0, {0}},
    {"experiment_cone.yaml", FaultKind::every_third_short, 0, {0}},
    {"experiment_cone.yaml", FaultKind::turned, 1, {8, 25}},
    {"experiment_cone.yaml", FaultKind::turned, 2, {8}},
    {"experiment_cone.yaml", FaultKind::exchanged, 1, {0, 8, 16, 17}},
    {"experiment_cone.yaml", FaultKind::exchanged, 8, {0, 16, 17}},
    {"experiment_zones.yaml", FaultKind::too_long, 0, {8, 16, 17, 28, 31}},
    {"experiment_zones.yaml", FaultKind::too_short, 0, {0}},
    {"experiment_zones.yaml", FaultKind::every_third_short, 0, {8, 16}},
    {"experiment_zones.yaml", FaultKind::turned, 0, {0, 31}},
    {"experiment_zones.yaml", FaultKind::turned, 1, {0}},
    {"experiment_zones.yaml", FaultKind::turned, 2, {8}},
    {"experiment_zones.yaml", FaultKind::turned, 4, {0}},
    {"experiment_zones.yaml", FaultKind::turned, 6, {16}},
    {"experiment_zones.yaml", FaultKind::turned, 7, {0}},
    {"experiment_zones.yaml", FaultKind::exchanged, 1, {8, 16, 17}},
    {"experiment_zones.yaml", FaultKind::exchanged, 8, {0, 17}},
};

}  // namespace octoskin::testing_support
