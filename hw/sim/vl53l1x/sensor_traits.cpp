#include "hw/sim/vl53l1x/sensor_traits.hpp"

#include <algorithm>
#include <charconv>

namespace octoskin::sim {
namespace {

bool is_meant(const std::optional<std::uint8_t>& wanted, std::uint8_t found) {
    return !wanted || *wanted == found;
}

std::optional<std::uint32_t> number_in(std::string_view text) {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// `reads` and `mask` are of the register named last.
bool set(TraitsOf& of, std::string_view key, std::uint32_t value) {
    SensorTraits& traits = of.traits;
    const bool is_byte = value <= 255;
    if (key == "sensor" && is_byte) {
        of.sensor = static_cast<std::uint8_t>(value);
    } else if (key == "register" && value <= 0xFFFF) {
        traits.misread.push_back({.index = static_cast<std::uint16_t>(value)});
    } else if (key == "reads" && is_byte && !traits.misread.empty()) {
        traits.misread.back().value = static_cast<std::uint8_t>(value);
    } else if (key == "mask" && is_byte && !traits.misread.empty()) {
        traits.misread.back().mask = static_cast<std::uint8_t>(value);
    } else if (key == "range_spread_us") {
        traits.range_spread = Microseconds{value};
    } else if (key == "range_step_us") {
        traits.range_step = Microseconds{value};
    } else if (key == "boot_load_us") {
        traits.boot_load = Microseconds{value};
    } else {
        return false;
    }
    return true;
}

}  // namespace

SensorTraits traits_of(const std::vector<TraitsOf>& all, std::uint8_t node_id, std::uint8_t sensor) {
    SensorTraits sum;
    for (const TraitsOf& of : all) {
        if (!is_meant(of.node_id, node_id) || !is_meant(of.sensor, sensor)) continue;
        sum.misread.insert(sum.misread.end(), of.traits.misread.begin(), of.traits.misread.end());
        sum.range_spread = std::max(sum.range_spread, of.traits.range_spread);
        sum.range_step = std::max(sum.range_step, of.traits.range_step);
        sum.boot_load = std::max(sum.boot_load, of.traits.boot_load);
    }
    return sum;
}

std::string to_text(const TraitsOf& of) {
    std::string text;
    const auto add = [&text](const char* key, std::int64_t value) {
        if (!text.empty()) text += ',';
        text += key;
        text += '=';
        text += std::to_string(value);
    };
    if (of.sensor) add("sensor", *of.sensor);
    for (const MisreadRegister& misread : of.traits.misread) {
        add("register", misread.index);
        add("reads", misread.value);
        add("mask", misread.mask);
    }
    add("range_spread_us", of.traits.range_spread.count());
    add("range_step_us", of.traits.range_step.count());
    add("boot_load_us", of.traits.boot_load.count());
    return text;
}

std::optional<TraitsOf> parse_traits(std::string_view text) {
    TraitsOf of;
    while (!text.empty()) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const std::string_view part = text.substr(0, comma);
        text.remove_prefix(std::min(comma + 1, text.size()));
        const std::size_t equals = part.find('=');
        if (equals == std::string_view::npos) return std::nullopt;
        const auto value = number_in(part.substr(equals + 1));
        if (!value || !set(of, part.substr(0, equals), *value)) return std::nullopt;
    }
    return of;
}

}  // namespace octoskin::sim
