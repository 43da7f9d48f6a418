// The texts of the report on one run: captions, idealisations, the command. They depend on the rig, the
// scenario and the request only.
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

/// Caption of the scene picture. `beams`: number of range sensors whose beam is drawn.
[[nodiscard]] std::string scene_caption(const rig::Rig& rig, const sim::Scenario& scenario,
                                        std::size_t beams);

/// What this simulation leaves out or simplifies compared with a robot cell, one sentence each.
[[nodiscard]] std::vector<std::string> idealisations_of(const rig::Rig& rig, const sim::Scenario& scenario);

/// How the ranges of this rig's sensors are mapped: which as rays, which as counts.
[[nodiscard]] report::RangeCounting range_counting_of(const rig::Rig& rig, const MappingConfig& mapping);

/// The shell command that repeats a study, with every option written out.
[[nodiscard]] std::string command_of(const StudyRequest& request);

}  // namespace octoskin
