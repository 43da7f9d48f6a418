#include "hw/sim/world/sdf_solids.hpp"

#include <string>
#include <utility>

#include "common/cut_text.hpp"

namespace octoskin::sim {
namespace {

/// Limits the length of a message about an untrusted file.
std::string cut_message(const std::string& text) {
    constexpr std::size_t kShown = 1000;
    return cut_text(text, kShown);
}

}  // namespace

SolidsOrError read_solids(const FilePlace& sdf, const ReadLimits& limits) {
    const auto failed = [&](const std::string& what) {
        return unexpected(WorldError{sdf.shown(), "", what});
    };
    const auto bytes = read_in_process(sdf, limits);
    if (!bytes) {
        return unexpected(WorldError{sdf.shown(), "", bytes.error().what, bytes.error().is_reader_missing});
    }
    auto solids = from_bytes(*bytes);
    if (!solids) return failed("the reader's output is incomplete");
    if (*solids) {
        for (std::string& warning : (*solids)->warnings)
            warning = sdf.shown().string() + ": " + cut_message(warning);
        return std::move(*solids);
    }
    return unexpected(
        WorldError{sdf.shown(), cut_message(solids->error().element), cut_message(solids->error().what)});
}

}  // namespace octoskin::sim
