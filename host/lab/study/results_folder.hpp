// Where an experiment's results go: what an experiment left there may be replaced, anything else may not.
#pragma once

#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// That an experiment may write its results into `folder`: nothing is in it, or the results of one before,
/// each file byte for byte as it was left and noted, and beside them what no experiment writes; and in the
/// place of each file lies nothing that cannot be replaced. Changes nothing. To be called while the folder is
/// locked (MapFolder), and once before, as to lock it clears away what a killed octoskin left. Error:
/// cannot_create, which names what would be lost or is in the way. Reads all that would be replaced.
[[nodiscard]] Status<AppError> check_results_folder(const OpenFolder& folder);

/// Notes in `folder` that its `name` (metrics.json, report.html, maps.yaml, or each file of the directory
/// recording) is there as this experiment made it. The maps are noted by maps.yaml (MapOrigin). Error:
/// cannot_create.
[[nodiscard]] Status<AppError> note_result(const OpenFolder& folder, const std::string& name);

}  // namespace octoskin
