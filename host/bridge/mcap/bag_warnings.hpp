// Sentences about what an import did not use, with remedies.
#pragma once

#include <string>
#include <vector>

#include "host/bridge/mcap/bag_camera.hpp"
#include "host/bridge/mcap/bag_import.hpp"
#include "host/bridge/mcap/bag_log.hpp"
#include "host/bridge/mcap/bag_survey.hpp"
#include "host/bridge/received/joint_states.hpp"
#include "host/io/mcap/mcap_reader.hpp"

namespace octoskin::bridge {

/// Damage of the file; topics that are needed and missing; topics of which more than half is not used.
[[nodiscard]] std::vector<std::string> warnings_about(const ImportedBag& imported,
                                                      const mcap::McapReader& reader, const BagSurvey& survey,
                                                      const BagTopics& topics,
                                                      const std::vector<BagCamera>& cameras,
                                                      const JointStates& joints, const BagLog& log);

}  // namespace octoskin::bridge
