// The folder of an experiment's results. Results of an earlier experiment may be replaced, other files may
// not.
#pragma once

#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// Checks that an experiment may write its results into `folder`: it is empty, or the result files in it are
/// byte for byte as an earlier experiment noted them (other files may be beside them), and each place can be
/// replaced. Changes nothing. Call it while the folder is locked (MapFolder), and once before: locking
/// removes leftovers of a killed octoskin. Error: cannot_create, with the name of the file in the way. Reads
/// all files that would be replaced.
[[nodiscard]] Status<AppError> check_results_folder(const OpenFolder& folder);

/// Notes in `folder` the CRC-32 of `name` (metrics.json, report.html, maps.yaml, or each file of the
/// directory recording) as a result of this experiment. maps.yaml notes the maps (MapOrigin). Error:
/// cannot_create.
[[nodiscard]] Status<AppError> note_result(const OpenFolder& folder, const std::string& name);

}  // namespace octoskin
