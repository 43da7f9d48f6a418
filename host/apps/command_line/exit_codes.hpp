// The one table of exit codes: --help and docs/reference/command-line.md are rendered from it.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace octoskin::app {

struct ExitCodeMeaning {
    std::string_view codes;  ///< one code, or several that mean alike: "129, 130"
    std::string_view meaning;
    bool is_of_queries = false;  ///< only octoskin query ends with it
};

/// All exit codes of octoskin and octoskin-lab, in ascending order. A command's own --help states what a code
/// means there. Those below 128 are the values of ExitCode, and 70.
[[nodiscard]] std::span<const ExitCodeMeaning> exit_code_meanings() noexcept;

/// "Exit codes: 0 done; 1 ...", a line of at most 100 characters each, without a newline at the end.
/// `has_queries`: with the codes of queries.
[[nodiscard]] std::string exit_codes_text(bool has_queries);

}  // namespace octoskin::app
