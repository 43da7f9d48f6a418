// Lines of a candump log: what is read is written back as a line that reads the same.
#include <cassert>

#include "host/io/candump/log_line.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin::candump {
namespace {

void check(std::string_view line) {
    const auto entry = parse_line(line);
    if (!entry) {
        assert(entry.error() != LineFault::too_long && entry.error() != LineFault::truncated);
        return;
    }
    const std::string written = format_line(*entry);
    assert(written.ends_with('\n') && written.size() <= kLineBytesMax);
    const auto again = parse_line(std::string_view(written).substr(0, written.size() - 1));
    assert(again && *again == *entry);
}

}  // namespace
}  // namespace octoskin::candump

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view rest = octoskin::fuzz::text_of({data, size});
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        octoskin::candump::check(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return 0;
}
