#include "host/apps/daemon/next_settings.hpp"

#include <new>
#include <utility>

namespace octoskin {

NextResult read_next(const DaemonRequest& request, const RecordedSettings& held) {
    try {
        auto read = read_settings(request);
        if (!read) return unexpected(read.error());
        if (read->recorded == held) return std::optional<Next>{};
        auto made = make_pipeline(request, *read);
        if (!made) return unexpected(made.error());
        return std::optional(Next{std::move(read).value(), std::move(made).value()});
    } catch (const std::bad_alloc&) {
        return fail(ExitCode::bad_config,
                    {ErrorCode::no_resources, "no memory to read the rig, robot and mapping files"});
    }
}

}  // namespace octoskin
