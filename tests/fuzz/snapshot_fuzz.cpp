// A snapshot of a map's state, as it is and with its checksums mended: what is accepted is written and read
// back the same, bit by bit, and a map goes on from it.
#include <cassert>
#include <string>

#include "host/io/snapshot/snapshot.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/support/snapshot/map_states.hpp"
#include "tests/support/snapshot/mended.hpp"

namespace octoskin {
namespace {

constexpr std::uint32_t kMapping = 0x12345678;

void check(std::string_view bytes, bool is_measured) {
    const MappingConfig mapping = testing_support::quickly_aging();
    auto snapshot = decode_snapshot(bytes, mapping, kMapping);
    if (!snapshot) {
        assert(!snapshot.error().what.empty());
        return;
    }
    const std::string written = encode_snapshot(snapshot->state, snapshot->origin);
    const auto again = decode_snapshot(written, mapping, kMapping);
    assert(again && again->origin == snapshot->origin);
    assert(encode_snapshot(again->state, again->origin) == written);
    if (!is_measured) return;
    testing_support::MeasuredMap map(mapping, std::move(snapshot->state));
    map.map().begin_to_wait();
    (void)map.map().wait(3);
    map.measure(7, 40, 100.0);
    assert(decode_snapshot(encode_snapshot(map.state(), {.mapping_crc32 = kMapping}), mapping, kMapping));
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes = octoskin::fuzz::text_of({data, size});
    octoskin::check(bytes, false);
    octoskin::check(octoskin::testing_support::mended(bytes), true);
    return 0;
}
