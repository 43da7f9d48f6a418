// The settings of a reload: read, checked and built beside the loop.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "host/apps/daemon/settings.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/pipeline/pipeline.hpp"

namespace octoskin {

struct Next {
    Settings settings;
    Pipeline pipeline;
};
/// Empty: the files are unchanged.
using NextResult = Result<std::optional<Next>, AppError>;

/// `held`: the settings in force. Waits for the files; uses no other state that changes, so it may be called
/// from any thread. Errors as for read_settings and make_pipeline, and bad_config if there is no memory.
[[nodiscard]] NextResult read_next(const DaemonRequest& request, const RecordedSettings& held);

}  // namespace octoskin
