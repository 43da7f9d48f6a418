// Prints the transfers of a dump in the language of the I2C test scripts (tests/support/i2c/i2c_trace.hpp).
#pragma once

#include <string>

#include "host/core/black_box/dump_assembler.hpp"

namespace octoskin {

/// One line per transfer, as far as the dump can be read. Comments ('#') state what the dump is and which
/// part is missing or damaged. Times are those of the node's clock, each with the time since the transfer
/// before it. Any input bytes are safe.
[[nodiscard]] std::string transfer_script(const Dump& dump);

}  // namespace octoskin
