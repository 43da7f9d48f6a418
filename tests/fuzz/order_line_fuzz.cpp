// Lines of order.log: what is read is written back as a line that reads the same.
#include <algorithm>
#include <array>
#include <cassert>

#include "host/io/orderlog/order_line.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin::orderlog {
namespace {

std::string_view without_feed(const std::string& line) {
    assert(line.ends_with('\n') && line.size() <= kLineBytesMax);
    return std::string_view(line).substr(0, line.size() - 1);
}

void check(std::string_view line) {
    static const std::array kForms{CommitForm{.joints = {2, 1}}, CommitForm{.joints = {2}, .cameras = 3}};
    if (const auto header = parse_header(line)) {
        assert(parse_header(without_feed(format_header(*header))) == header);
    }
    if (const auto trailer = parse_trailer(line)) {
        assert(parse_trailer(without_feed(format_trailer(*trailer))) == trailer);
    }
    for (const CommitForm& form : kForms) {
        const auto commit = parse_commit(line, form);
        if (!commit) continue;
        const std::string written = format_commit(*commit, form);
        const auto again = parse_commit(without_feed(written), form);
        assert(again && format_commit(*again, form) == written);
    }
}

}  // namespace
}  // namespace octoskin::orderlog

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view rest = octoskin::fuzz::text_of({data, size});
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        octoskin::orderlog::check(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return 0;
}
