// Each instruction set of this processor for which code was compiled with Highway.
#pragma once

#include <hwy/targets.h>

#include <functional>
#include <string>

namespace octoskin {

/// Calls test(name) with each instruction set of this processor chosen in turn.
inline void on_each_instruction_set(const std::function<void(const std::string&)>& test) {
    const auto targets = hwy::SupportedTargets();
    for (auto left = targets; left != 0; left &= left - 1) {
        const auto target = left & -left;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        test(hwy::TargetName(target));
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace octoskin
