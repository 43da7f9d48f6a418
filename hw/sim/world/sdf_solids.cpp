#include "hw/sim/world/sdf_solids.hpp"

#include <string>
#include <utility>

namespace octoskin::sim {

SolidsOrError read_solids(const FilePlace& sdf, const ReadLimits& limits) {
    const auto failed = [&](const std::string& what) {
        return unexpected(WorldError{sdf.shown(), "", what});
    };
    const auto bytes = read_in_process(sdf, limits);
    if (!bytes) return failed(bytes.error());
    auto solids = from_bytes(*bytes);
    if (!solids) return failed("what reads it broke off");
    if (*solids) {
        for (std::string& warning : (*solids)->warnings) warning = sdf.shown().string() + ": " + warning;
        return std::move(*solids);
    }
    return unexpected(WorldError{sdf.shown(), solids->error().element, solids->error().what});
}

}  // namespace octoskin::sim
