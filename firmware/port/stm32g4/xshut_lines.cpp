#include "firmware/port/stm32g4/xshut_lines.hpp"

#include <cassert>
#include <iterator>

#include "common/config/node_config.hpp"
#include "firmware/port/stm32g4/pin.hpp"

namespace octoskin::stm32g4 {

namespace {

// A0 to A3, D12, D11, D6 and D4 of the NUCLEO's Arduino sockets.
constexpr Pin kPins[] = {{gpio_a, 0}, {gpio_a, 1}, {gpio_a, 4},  {gpio_b, 0},
                         {gpio_a, 6}, {gpio_a, 7}, {gpio_b, 10}, {gpio_b, 5}};
static_assert(XshutChain::kLines + std::size(kPins) == kNodeXshutLinesMax);

}  // namespace

void XshutLines::start() {
    for (const Pin& pin : kPins) {
        pin.set(false);
        pin.make_output(Drive::open_drain);
    }
    chain_.start();
}

void XshutLines::set(std::uint8_t line, bool is_high) {
    assert(line < kNodeXshutLinesMax);
    if (line < XshutChain::kLines) {
        chain_.set(line, is_high);
    } else {
        kPins[line - XshutChain::kLines].set(is_high);
    }
}

}  // namespace octoskin::stm32g4
