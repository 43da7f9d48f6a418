// The transfers of a dump in the language of our I2C test scripts (tests/support/i2c/i2c_trace.hpp).
#pragma once

#include <string>

#include "host/core/black_box/dump_assembler.hpp"

namespace octoskin {

/// One line a transfer, as far as the dump can be read; what it is, and what is wrong with it, as comments
/// ('#'). Times are the node's clock, and the time since the transfer before. Any bytes are safe.
[[nodiscard]] std::string transfer_script(const Dump& dump);

}  // namespace octoskin
