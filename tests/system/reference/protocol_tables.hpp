// The tables of docs/protocol.md: types, senders, messages, named values, bus load.
#pragma once

#include "tests/system/reference/page_tables.hpp"

namespace octoskin {

[[nodiscard]] Tables protocol_tables();

}  // namespace octoskin
