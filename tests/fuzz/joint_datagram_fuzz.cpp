// A datagram of the joint socket of two sources, behind a byte that says how many joints the second has: what
// is taken fits the wire and its time is near; what is refused has a reason in words.
#include <cassert>
#include <cmath>

#include "host/apps/daemon/joint_line.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    if (size == 0) return 0;
    constexpr HostTime kNow{1'000'000'000'000};
    const std::size_t count = 1 + data[0] % 7;
    LineJoints joints{{{.index = 0, .names = {"a", "b"}, .rate_hz = 100.0, .turns = {false, true}}, {}}};
    for (std::size_t i = 0; i < count; ++i)
        joints.sources[1].names.push_back(std::string(1, static_cast<char>('c' + i)));
    const auto came = (data[0] & 8) != 0 ? std::optional(kNow) : std::nullopt;
    const std::string_view text = fuzz::text_of({data + 1, size - 1});
    const auto line = parse_joints(text, joints, kNow, came);
    if (!line) {
        assert(!describe(line.error(), text, joints, kNow).empty());
        return 0;
    }
    assert(!line->samples.empty());
    for (const JointSample& sample : line->samples) {
        assert(sample.position.size() == joints.sources.at(sample.source).names.size());
        for (const double position : sample.position) assert(std::abs(position) <= 8.388608);
        const Nanoseconds off = sample.sampled - kNow;
        assert(off <= Nanoseconds{1'000'000'000} && off >= -Nanoseconds{1'000'000'000});
    }
    return 0;
}
