#include "hw/sim/vl53l1x/register_map.hpp"

#include <initializer_list>

namespace octoskin::sim {
namespace {

struct ResetValue {
    std::uint16_t index;
    std::initializer_list<std::uint8_t> bytes;
};

Registers make_reset_registers() {
    // Dump of one real part (os.mbed.com, VL53L1X-MAX); 0x5E..0x63, 0xD8 and 0x06 are any decodable values.
    const std::initializer_list<ResetValue> values{
        {0x0001, {0x29}},
        {0x0006, {0xBC, 0x7A}},
        {0x0008, {0x81, 0x80, 0x07, 0x95}},
        {0x001E, {0x00, 0x34}},
        {0x0020, {0x00, 0x28}},
        {0x0022, {0x00, 0x0D}},
        {0x0024, {0x0A, 0x00}},
        {0x0030, {0x11, 0x02}},
        {0x0046, {0x20}},
        {0x005E, {0x01, 0x92, 0x0B, 0x01, 0x92, 0x09}},
        {0x0064, {0x01, 0x68, 0x00, 0x80, 0x08, 0x78}},
        {0x006C, {0x00, 0x00, 0x0E, 0x10}},
        {0x007F, {0xC7, 0xFF}},
        {0x0085, {0x01}},
        {0x00D8, {0x0B}},
        {0x010F, {0xEA, 0xCC, 0x10}},
    };
    Registers registers{};
    for (const ResetValue& value : values) {
        std::uint16_t index = value.index;
        for (const std::uint8_t byte : value.bytes) registers.at(index++) = byte;
    }
    return registers;
}

}  // namespace

const Registers& reset_registers() {
    static const Registers registers = make_reset_registers();
    return registers;
}

}  // namespace octoskin::sim
