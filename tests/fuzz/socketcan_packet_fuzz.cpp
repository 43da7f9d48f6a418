// Packets of a CAN socket, each behind a byte that says how many bytes it has: what is taken for a frame is
// the same when it is sent again, and when it is read from the log that it was written into.
#include <algorithm>
#include <cassert>

#include "common/wire/socketcan_layout.hpp"
#include "host/io/candump/log_line.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin {
namespace {

void check(std::span<const std::uint8_t> packet) {
    const auto frame = wire::from_socketcan(std::as_bytes(packet));
    if (!frame) return;
    assert(wire::from_socketcan(wire::to_socketcan(*frame).bytes()) == frame);
    const candump::LogEntry entry{.stamp = {1'750'000'000'123'456'000}, .interface = "can0", .frame = *frame};
    const std::string line = candump::format_line(entry);
    const auto read = candump::parse_line(std::string_view(line).substr(0, line.size() - 1));
    assert(read && *read == entry);
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::span<const std::uint8_t> rest(data, size);
    while (!rest.empty()) {
        const std::size_t length = std::min<std::size_t>(rest.front(), rest.size() - 1);
        octoskin::check(rest.subspan(1, length));
        rest = rest.subspan(1 + length);
    }
    return 0;
}
