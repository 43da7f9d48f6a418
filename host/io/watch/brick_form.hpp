// How the values of one brick are stored in a payload.
#pragma once

#include <cstdint>

namespace octoskin::watch {

enum class BrickForm : std::uint8_t { unknown, alike, runs };

}  // namespace octoskin::watch
