// What the report says of one run in words: captions, idealisations, the command. All of it follows from the
// rig, the scenario and the request.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/core/mapping/mapping_config.hpp"
#include "host/lab/report/report.hpp"
#include "host/lab/study/study.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/scenario/scenario.hpp"

namespace octoskin {

/// What the scene picture shows. `beams`: of how many range sensors a beam is drawn.
[[nodiscard]] std::string scene_caption(const rig::Rig& rig, const sim::Scenario& scenario,
                                        std::size_t beams);

/// What this simulation leaves out or makes kinder than a robot cell, one sentence each.
[[nodiscard]] std::vector<std::string> idealisations_of(const rig::Rig& rig, const sim::Scenario& scenario);

/// How the ranges of this rig's sensors come into the map: which as rays, which as counts.
[[nodiscard]] report::RangeCounting range_counting_of(const rig::Rig& rig, const MappingConfig& mapping);

/// The shell command that does a study again, every choice written out.
[[nodiscard]] std::string command_of(const StudyRequest& request);

}  // namespace octoskin
