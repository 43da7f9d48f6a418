#include "common/range_status.hpp"

#include <array>
#include <cassert>

namespace octoskin {
namespace {

using enum RangeStatus;
using enum RangeUse;

// Where ST's two drivers disagree, the table follows the one that gives a status other than 255: the full API
// for the hardware faults 1, 2 and 17, the ULD for 22 and 23.
constexpr std::array<RangeStatusEntry, 32> kTable = {{
    {none, nothing, "no result yet"},
    {hardware_fail, nothing, "VCSEL continuity test failed"},
    {hardware_fail, nothing, "VCSEL watchdog test failed"},
    {hardware_fail, nothing, "no VHV value found"},
    {signal_fail, no_return, "no target: signal below its limit"},
    {out_of_bounds, nothing, "phase out of bounds"},
    {sigma_fail, nothing, "sigma above its limit"},
    {wrapped_target, nothing, "wrapped target: phases inconsistent"},
    {valid_min_clipped, nothing, "closer than the minimum range"},
    {valid, hit, "valid"},
    {none, nothing, "algorithm underflow"},
    {none, nothing, "algorithm overflow"},
    {crosstalk_signal_fail, nothing, "crosstalk above its limit"},
    {roi_misfit, nothing, "region of interest does not fit"},
    {none, nothing, "reference SPADs: not enough"},
    {none, nothing, "reference SPADs: rate too high"},
    {none, nothing, "reference SPADs: rate too low"},
    {hardware_fail, nothing, "multiple clips failed"},
    {synchronisation, nothing, "group hold, stream 0 ready: no measurement"},
    {valid_no_wrap_check, nothing, "first range: no wrap check"},
    {none, nothing, "event consistency"},
    {none, nothing, "minimum signal event check"},
    {merged_pulse, nothing, "merged targets"},
    {weak_target, nothing, "previous range had no target"},
    {none, nothing, "undefined code 24"},
    {none, nothing, "undefined code 25"},
    {none, nothing, "undefined code 26"},
    {none, nothing, "undefined code 27"},
    {none, nothing, "undefined code 28"},
    {none, nothing, "undefined code 29"},
    {none, nothing, "undefined code 30"},
    {none, nothing, "undefined code 31"},
}};

}  // namespace

const RangeStatusEntry& range_status(std::uint8_t device_code) noexcept {
    assert(device_code < kTable.size());
    return kTable[device_code];
}

}  // namespace octoskin
