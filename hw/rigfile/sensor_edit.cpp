#include "hw/rigfile/sensor_edit.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <vector>

#include "host/io/folder/confined.hpp"
#include "hw/rigfile/rig_keys.hpp"

namespace octoskin::rig {
namespace {

/// The value of a declared key.
YAML::Node value_of(const YAML::Node& table, const DeclaredKey auto& key) {
    return table[std::string(name_of(key))];
}

bool is_named(const YAML::Node& table, const TextKey& key, const std::string& name) {
    if (!table.IsMap()) return false;
    const YAML::Node found = value_of(table, key);
    return found && found.IsScalar() && found.Scalar() == name;
}

std::optional<YAML::Node> find_sensor(const YAML::Node& top, const SensorEdit& edit) {
    if (!top.IsMap()) return std::nullopt;
    const YAML::Node nodes = value_of(top, keys::kNodes);
    if (!nodes || !nodes.IsSequence()) return std::nullopt;
    for (const YAML::Node& node : nodes) {
        if (!is_named(node, keys::node::kName, edit.node)) continue;
        const YAML::Node sensors = value_of(node, keys::node::kSensors);
        if (!sensors || !sensors.IsSequence()) continue;
        for (const YAML::Node& sensor : sensors) {
            if (is_named(sensor, keys::sensor::kName, edit.sensor)) return sensor;
        }
    }
    return std::nullopt;
}

struct Place {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// The position of a scalar on one line; empty for any other notation.
std::optional<Place> place_of(const YAML::Node& scalar, const std::string& text) {
    const auto begin = static_cast<std::size_t>(scalar.Mark().pos);
    if (!scalar.IsScalar() || begin >= text.size()) return std::nullopt;
    const bool is_quoted = text[begin] == '"' || text[begin] == '\'';
    const Place place{begin, begin + scalar.Scalar().size() + (is_quoted ? 2U : 0U)};
    const std::size_t first = begin + (is_quoted ? 1U : 0U);
    if (text.compare(first, scalar.Scalar().size(), scalar.Scalar()) != 0) return std::nullopt;
    return place;
}

std::optional<std::string> with_value(const std::string& text, const YAML::Node& sensor,
                                      const SensorEdit& edit) {
    for (const auto& item : sensor) {
        if (item.first.Scalar() != edit.key) continue;
        const auto place = place_of(item.second, text);
        if (!place) return std::nullopt;
        return text.substr(0, place->begin) + edit.value + text.substr(place->end);
    }
    for (const auto& item : sensor) {
        if (item.first.Scalar() != name_of(keys::sensor::kName)) continue;
        const auto place = place_of(item.second, text);
        if (!place) return std::nullopt;
        const std::string entry = edit.key + ": " + edit.value;
        if (sensor.Style() == YAML::EmitterStyle::Flow)
            return text.substr(0, place->end) + ", " + entry + text.substr(place->end);
        const std::size_t line_end = std::min(text.find('\n', place->end), text.size());
        const std::string indent(static_cast<std::size_t>(item.first.Mark().column), ' ');
        return text.substr(0, line_end) + "\n" + indent + entry + text.substr(line_end);
    }
    return std::nullopt;
}

Unexpected<Error> failed(const std::filesystem::path& file, ErrorCode code, std::string what,
                         std::string remedy = {}) {
    return unexpected(
        Error{.code = code, .what = std::move(what), .remedy = std::move(remedy), .file = file});
}

/// Empty if the file cannot be read.
std::string content_of(const FilePlace& file) {
    constexpr std::size_t kBytesMax = std::size_t{16} << 20U;
    const auto opened = file.open();
    auto text = opened ? opened->read(kBytesMax) : unexpected(opened.error());
    return text && text->size() <= kBytesMax ? std::move(*text) : std::string();
}

/// An extended file may contain sensors that the rig no longer has.
bool has_sensor(const Rig& rig, const SensorEdit& edit) {
    for (const Node& node : rig.nodes) {
        if (node.name != edit.node) continue;
        const auto is_it = [&edit](const Sensor& sensor) { return sensor.name == edit.sensor; };
        return std::any_of(node.sensors.begin(), node.sensors.end(), is_it);
    }
    return false;
}

/// The rig with this one sensor replaced by that of `other`.
Rig with_sensor_of(Rig rig, const Rig& other, const SensorEdit& edit) {
    for (std::size_t n = 0; n < rig.nodes.size() && n < other.nodes.size(); ++n) {
        const auto& sensors = rig.nodes[n].sensors;
        for (std::size_t s = 0; rig.nodes[n].name == edit.node && s < sensors.size(); ++s) {
            if (sensors[s].name == edit.sensor)
                rig.nodes[n].config.sensors[s] = other.nodes[n].config.sensors[s];
        }
    }
    return rig;
}

}  // namespace

std::optional<std::string> edited(const std::string& text, const SensorEdit& edit) {
    try {
        const auto sensor = find_sensor(YAML::Load(text), edit);
        return sensor ? with_value(text, *sensor, edit) : std::nullopt;
    } catch (const YAML::Exception&) {
        return std::nullopt;
    }
}

Result<std::filesystem::path, Error> edit_sensor(const std::filesystem::path& file, const SensorEdit& edit,
                                                 const SaveText& save) {
    const auto before = read_rig(file);
    if (!before) return unexpected(before.error());
    if (!has_sensor(*before, edit))
        return failed(file, ErrorCode::unknown_name,
                      "has no sensor '" + edit.sensor + "' of a node '" + edit.node + "'");
    std::vector<FilePlace> files{confined_to_recording(file)};
    files.insert(files.end(), before->extended_files.begin(), before->extended_files.end());
    for (const auto& candidate : files) {
        const std::string text = content_of(candidate);
        const auto changed = edited(text, edit);
        if (!changed) continue;
        if (const auto why = save(candidate, *changed))
            return failed(candidate.shown(), ErrorCode::system_error, *why);
        const auto after = read_rig(file);
        const bool is_as_meant =
            after && rig_hash(with_sensor_of(*after, *before, edit)) == rig_hash(*before);
        if (is_as_meant) return candidate.shown();
        if (const auto why = save(candidate, text))
            return failed(candidate.shown(), ErrorCode::system_error,
                          "was changed and cannot be put back: " + *why);
        return after ? failed(candidate.shown(), ErrorCode::unsupported,
                              "its sensor cannot be changed by a program",
                              "set " + edit.key + ": " + edit.value + " by hand")
                     : unexpected(after.error());
    }
    return failed(file, ErrorCode::unknown_name,
                  "no sensor '" + edit.sensor + "' of node '" + edit.node + "' is written in it");
}

}  // namespace octoskin::rig
