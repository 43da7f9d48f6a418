#include "hw/rigfile/element_fault.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace octoskin::rig {

RigError one_error_of(std::vector<ElementFault> faults) {
    assert(!faults.empty());
    std::ranges::stable_sort(faults, {}, [](const ElementFault& fault) { return fault.error.line; });
    RigError error = std::move(faults[0].error);
    if (faults.size() == 1) return error;
    error.what += fmt::format(". {} more cannot be taken: ", faults.size() - 1);
    for (std::size_t i = 1; i < faults.size(); ++i) {
        error.what += fmt::format("{}{} (line {}, {})", i == 1 ? "" : ", ", faults[i].error.key,
                                  faults[i].error.line, faults[i].kind);
    }
    return error;
}

}  // namespace octoskin::rig
