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
    const auto failed = [&](Error error) {
        error.file = sdf.shown();
        return unexpected(std::move(error));
    };
    const auto bytes = read_in_process(sdf, limits);
    if (!bytes) return failed(bytes.error());
    auto solids = from_bytes(*bytes);
    if (!solids) return failed({ErrorCode::damaged, "the reader's output is incomplete"});
    if (*solids) {
        for (std::string& warning : (*solids)->warnings)
            warning = sdf.shown().string() + ": " + cut_message(warning);
        return std::move(*solids);
    }
    Error error = solids->error();
    for (std::string* text : {&error.key, &error.what, &error.value, &error.remedy})
        *text = cut_message(*text);
    return failed(std::move(error));
}

}  // namespace octoskin::sim
