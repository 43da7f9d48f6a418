// The only place where an address becomes a register access. On the board these are single loads and stores;
// tests on the PC link their own versions and observe each access (tests/support/stm32g4).
#pragma once

#include <cstdint>

namespace octoskin::stm32g4 {

using Address = std::uint32_t;

#if defined(__arm__)
[[nodiscard]] inline std::uint32_t load(Address address) {
    return *reinterpret_cast<const volatile std::uint32_t*>(address);
}
inline void store(Address address, std::uint32_t value) {
    *reinterpret_cast<volatile std::uint32_t*>(address) = value;
}
#else
[[nodiscard]] std::uint32_t load(Address address);
void store(Address address, std::uint32_t value);
#endif

}  // namespace octoskin::stm32g4
