#include "tests/support/i2c_device/fault_command.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace octoskin::test {
namespace {

using sim::I2cFaultKind;
using sim::SensorFaults;

constexpr std::array<std::pair<std::string_view, bool SensorFaults::*>, 7> kSensorFaults{{
    {"absent", &SensorFaults::is_absent},
    {"never_boots", &SensorFaults::never_boots},
    {"wrong_id", &SensorFaults::has_wrong_id},
    {"ignores_xshut", &SensorFaults::ignores_xshut},
    {"freezes_stream", &SensorFaults::freezes_stream},
    {"never_ready", &SensorFaults::never_ready},
    {"always_ready", &SensorFaults::is_always_ready},
}};

constexpr std::array<std::pair<std::string_view, I2cFaultKind>, 10> kBusFaults{{
    {"nack_address", I2cFaultKind::nack_address},
    {"nack_byte", I2cFaultKind::nack_byte},
    {"nack_read", I2cFaultKind::nack_read},
    {"flip_bit", I2cFaultKind::flip_bit},
    {"flip_written_bit", I2cFaultKind::flip_written_bit},
    {"lose_write", I2cFaultKind::lose_write},
    {"read_ones", I2cFaultKind::read_ones},
    {"lose_arbitration", I2cFaultKind::lose_arbitration},
    {"stretch", I2cFaultKind::stretch},
    {"sda_stuck_low", I2cFaultKind::sda_stuck_low},
}};

std::vector<std::string> words(const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> all;
    for (std::string word; stream >> word;) all.push_back(word);
    return all;
}

template <typename Number>
std::optional<Number> number(std::string_view text) {
    const bool is_hexadecimal = text.starts_with("0x");
    if (is_hexadecimal) text.remove_prefix(2);
    std::uint32_t value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, is_hexadecimal ? 16 : 10);
    const bool is_whole = error == std::errc{} && end == text.data() + text.size();
    if (!is_whole || value > std::numeric_limits<Number>::max()) return std::nullopt;
    return static_cast<Number>(value);
}

std::optional<FaultCommand> bus_fault(const std::vector<std::string>& line) {
    if (line.size() < 4 || line.size() > 5) return std::nullopt;
    const auto count = number<std::uint32_t>(line[2]);
    const auto position = number<std::uint32_t>(line[3]);
    const auto address = line.size() == 5 ? number<i2c::Address>(line[4]) : std::nullopt;
    if (!count || !position || (line.size() == 5 && !address)) return std::nullopt;
    for (const auto& [name, kind] : kBusFaults) {
        if (name != line[1]) continue;
        return BusFaultCommand{
            {.kind = kind, .first = 0, .count = *count, .position = *position, .address = address}};
    }
    return std::nullopt;
}

std::optional<FaultCommand> sensor_fault(const std::vector<std::string>& line) {
    SensorFaultCommand command{.sensor = line[0]};
    if (line.size() == 3 && line[1] == "status") {
        command.faults.device_status = number<std::uint8_t>(line[2]);
        if (!command.faults.device_status) return std::nullopt;
        return command;
    }
    if (line.size() != 2) return std::nullopt;
    if (line[1] == "none") return command;
    if (line[1] == "brown_out") {
        command.is_brown_out = true;
        return command;
    }
    for (const auto& [name, fault] : kSensorFaults) {
        if (name != line[1]) continue;
        command.faults.*fault = true;
        return command;
    }
    return std::nullopt;
}

}  // namespace

std::optional<FaultCommand> parse_fault_command(const std::string& line) {
    const std::vector<std::string> all = words(line);
    if (all.size() < 2) return std::nullopt;
    return all[0] == "bus" ? bus_fault(all) : sensor_fault(all);
}

}  // namespace octoskin::test
