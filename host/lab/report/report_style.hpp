// The report's style sheet.
#pragma once

#include <string_view>

namespace octoskin::report {

[[nodiscard]] std::string_view report_style() noexcept;

}  // namespace octoskin::report
