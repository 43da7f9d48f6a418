// A datagram of the joint socket behind a byte that says how many joints the rig has: what is taken fits the
// wire and its time is near; what is refused has a reason in words.
#include <cassert>
#include <cmath>

#include "host/apps/daemon/joint_socket.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    if (size == 0) return 0;
    constexpr HostTime kNow{1'000'000'000'000};
    const std::size_t joints = 1 + data[0] % 7;
    const auto came = (data[0] & 8) != 0 ? std::optional(kNow) : std::nullopt;
    const std::string_view text = fuzz::text_of({data + 1, size - 1});
    const auto sample = parse_joints(text, joints, kNow, came);
    if (!sample) {
        assert(!describe(sample.error(), text, joints, kNow).empty());
        return 0;
    }
    assert(sample->position.size() == joints);
    for (const double position : sample->position) assert(std::abs(position) <= 8.388608);
    const Nanoseconds off = sample->sampled - kNow;
    assert(off <= Nanoseconds{1'000'000'000} && off >= -Nanoseconds{1'000'000'000});
    return 0;
}
