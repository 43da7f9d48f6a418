// What a reload goes on with: read, checked and built beside the loop.
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
/// Empty: the files say what holds already.
using NextResult = Result<std::optional<Next>, AppError>;

/// `held`: what holds. Waits for the files; touches nothing else that changes, so from any thread. Errors: as
/// read_settings and make_pipeline; bad_config, too, where there is no memory.
[[nodiscard]] NextResult read_next(const DaemonRequest& request, const RecordedSettings& held);

}  // namespace octoskin
