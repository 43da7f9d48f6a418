// The configuration block in a node's flash: what decodes is valid and encodes to the same bytes again. The
// first byte of the input says whether its length and checksum are to be made right first.
#include <algorithm>
#include <cassert>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/wire/crc.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin {
namespace {

/// "OSKC", version, length; fields; CRC-32, all little-endian.
void seal(std::vector<std::uint8_t>& block) {
    const std::size_t length = block.size();
    if (length < 12 || length > kNodeConfigBytesMax) return;
    block[6] = static_cast<std::uint8_t>(length);
    block[7] = static_cast<std::uint8_t>(length >> 8U);
    const std::uint32_t crc = crc32(std::span(block).first(length - 4));
    for (unsigned i = 0; i < 4; ++i) block[length - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

std::uint32_t u32_of(std::span<const std::uint8_t> bytes) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i) value |= std::uint32_t{bytes[i]} << (8 * i);
    return value;
}

void check(std::span<const std::uint8_t> memory) {
    const auto config = decode_node_config(memory);
    if (!config) return;
    assert(is_valid(*config));
    std::array<std::uint8_t, kNodeConfigBytesMax> out{};
    const auto block = encode(*config, out);
    assert(block.size() <= memory.size());
    assert(std::equal(block.begin(), block.end(), memory.begin()));
    const auto crc = block.last(4);
    assert(node_hash(*config) == u32_of(crc));
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    std::vector<std::uint8_t> block(data + 1, data + size);
    if (data[0] % 2 == 1) octoskin::seal(block);
    octoskin::check(block);
    return 0;
}
