#include "hw/rigfile/element_fault.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "common/cut_text.hpp"

namespace octoskin::rig {

Error one_error_of(std::vector<ElementFault> faults) {
    assert(!faults.empty());
    std::ranges::stable_sort(faults, {}, [](const ElementFault& fault) { return fault.error.line; });
    Error error = std::move(faults[0].error);
    if (faults.size() == 1) return error;
    error.others = fmt::format("{} more refused: ", faults.size() - 1);
    // A file may have thousands of them, with names of kilobytes.
    constexpr std::size_t kNamed = 20;
    constexpr std::size_t kKeyMax = 100;
    const std::size_t end = std::min(faults.size(), 1 + kNamed);
    for (std::size_t i = 1; i < end; ++i) {
        error.others +=
            fmt::format("{}{} (line {}, {})", i == 1 ? "" : ", ", cut_text(faults[i].error.key, kKeyMax),
                        faults[i].error.line, faults[i].kind);
    }
    if (end < faults.size()) error.others += fmt::format(", and {} further ones", faults.size() - end);
    return error;
}

}  // namespace octoskin::rig
