#include "firmware/port/stm32g4/reset_cause.hpp"

#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"

namespace octoskin::stm32g4 {

wire::ResetCause reset_cause(std::uint32_t csr, bool is_ram_kept) noexcept {
    using F = Field<RccMap>;
    using wire::ResetCause;
    const auto is_set = [csr](F flag) { return flag.of(csr) != 0; };
    if (is_set("CSR.BORRSTF")) return is_ram_kept ? ResetCause::brown_out : ResetCause::power_on;
    if (is_set("CSR.IWDGRSTF") || is_set("CSR.WWDGRSTF")) return ResetCause::watchdog;
    if (is_set("CSR.SFTRSTF")) return ResetCause::software;
    if (is_set("CSR.OBLRSTF"))
        return ResetCause::software;  // option bytes were loaded: the board is being flashed
    if (is_set("CSR.LPWRRSTF")) return ResetCause::unknown;  // low power modes are not used
    return is_set("CSR.PINRSTF") ? ResetCause::pin : ResetCause::unknown;
}

std::uint32_t take_reset_flags() {
    const std::uint32_t flags = rcc.read("CSR");
    rcc.set("CSR.RMVF", 1);
    rcc.set("CSR.RMVF", 0);
    return flags;
}

}  // namespace octoskin::stm32g4
