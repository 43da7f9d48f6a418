// Joint configurations as text: what is read is finite, and written with commas reads the same.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>

#include "host/apps/query/joint_lines.hpp"
#include "host/apps/query/query_request.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::istringstream stream{std::string(octoskin::fuzz::text_of({data, size}))};
    const auto path = octoskin::read_joint_path(stream, "fuzzed");
    if (!path) {
        assert(path.error().message().starts_with("fuzzed:"));
        return 0;
    }
    assert(path->lines.size() == path->configurations.size());
    assert(path->lines.size() <= octoskin::kConfigurationsMax && std::ranges::is_sorted(path->lines));
    for (const auto& configuration : path->configurations) {
        std::string written;
        for (const double number : configuration) {
            assert(std::isfinite(number));
            written += fmt::format("{}{}", written.empty() ? "" : ",", number);
        }
        const auto again = octoskin::read_numbers(written);
        assert(again && *again == configuration);
    }
    return 0;
}
