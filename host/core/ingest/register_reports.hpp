// What a node says of registers that its sensors do not read back as written: each on one sensor, or alike on
// several, where it is how this type of part is.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/wire/messages.hpp"

namespace octoskin {

class RegisterReports {
  public:
    /// A page with another fault changes nothing.
    void take(const wire::InfoFault& fault);

    /// Of one sensor; empty if its node named none, or has learnt since that it is alike on several.
    [[nodiscard]] const std::optional<wire::RegisterReport>& of_sensor(std::uint8_t sensor) const {
        return of_sensors_.at(sensor);
    }
    /// Alike on several sensors: of each register and value read one, at most as many as a node learns. Their
    /// subject is how many sensors had shown it when it was learnt.
    [[nodiscard]] const std::vector<wire::RegisterReport>& alike() const noexcept { return alike_; }

  private:
    static constexpr std::size_t kAlikeMax = 32;
    std::array<std::optional<wire::RegisterReport>, wire::kSensorsPerNodeMax> of_sensors_{};
    std::vector<wire::RegisterReport> alike_;
};

/// "register 0x47 was written 0x0B and reads 0x0C".
[[nodiscard]] std::string text_of(const wire::RegisterReport& report);
/// How to leave it out, for a person: the rig's key with that register. `node`: its name in the rig.
[[nodiscard]] std::string leave_out_text(const wire::RegisterReport& report, const std::string& node);
/// That several sensors have it alike, and that nothing is withheld for it.
[[nodiscard]] std::string alike_text(const wire::RegisterReport& report);

}  // namespace octoskin
