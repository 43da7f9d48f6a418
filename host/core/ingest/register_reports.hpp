// Registers that, by a node's reports, its sensors do not read back as written: on single sensors, or the
// same on several, which is a property of this type of part.
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
    /// Takes a fault page. A page with another kind of fault changes nothing.
    void take(const wire::InfoFault& fault);

    /// For one sensor; empty if its node reported none, or later found the same on several sensors.
    [[nodiscard]] const std::optional<wire::RegisterReport>& of_sensor(std::uint8_t sensor) const {
        return of_sensors_.at(sensor);
    }
    /// Registers that read the same on several sensors: one report for each register and value read, at most
    /// as many as a node stores. The `subject` of a report is the number of sensors that had shown it at that
    /// time.
    [[nodiscard]] const std::vector<wire::RegisterReport>& alike() const noexcept { return alike_; }

  private:
    static constexpr std::size_t kAlikeMax = 32;
    std::array<std::optional<wire::RegisterReport>, wire::kSensorsPerNodeMax> of_sensors_{};
    std::vector<wire::RegisterReport> alike_;
};

/// "register 0x47 was written 0x0B and reads 0x0C".
[[nodiscard]] std::string text_of(const wire::RegisterReport& report);
/// Text for people: the rig's key that leaves this register out. `node`: its name in the rig.
[[nodiscard]] std::string leave_out_text(const wire::RegisterReport& report, const std::string& node);
/// Text for people: several sensors have it, and no reading is withheld for it.
[[nodiscard]] std::string alike_text(const wire::RegisterReport& report);

}  // namespace octoskin
