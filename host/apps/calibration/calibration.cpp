#include "host/apps/calibration/calibration.hpp"

#include <fmt/format.h>

#include <optional>

#include "host/io/mapfile/atomic_file.hpp"

namespace octoskin::calibrating {

Result<Question, AppError> question_of(const rig::Rig& rig, const Wish& wish, std::uint8_t sequence) {
    std::string names;
    for (const rig::Node& node : rig.nodes) {
        const bool is_only = wish.node.empty() && rig.nodes.size() == 1;
        names += (names.empty() ? "" : ", ") + node.name;
        if (!is_only && node.name != wish.node && std::to_string(node.config.node_id) != wish.node) continue;
        std::string sensors;
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            sensors += (sensors.empty() ? "" : ", ") + node.sensors[i].name;
            if (node.sensors[i].name != wish.sensor) continue;
            return Question{.node_id = node.config.node_id,
                            .node_name = node.name,
                            .node_hash = node_hash(node.config),
                            .sensor = static_cast<std::uint8_t>(i),
                            .sensor_name = wish.sensor,
                            .quantity = wish.quantity,
                            .target_mm = wish.target_mm,
                            .inter_measurement_ms = node.config.sensors[i].inter_measurement_ms,
                            .sequence = sequence};
        }
        return fail(ExitCode::usage,
                    {.code = ErrorCode::unknown_name,
                     .what = fmt::format("expected a sensor of node {}, which has {}", node.name, sensors),
                     .value = "'" + wish.sensor + "'",
                     .key = "--sensor"});
    }
    if (wish.node.empty()) {
        return fail(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                      .what = "is missing",
                                      .remedy = "give one of " + names,
                                      .key = "--node"});
    }
    return fail(ExitCode::usage,
                {.code = ErrorCode::unknown_name,
                 .what = fmt::format("expected a node of rig {}, which has {}", rig.name, names),
                 .value = "'" + wish.node + "'",
                 .key = "--node"});
}

Dialogue::Outcome converse(Dialogue& dialogue, socketcan::CanSocket& socket, const Outside& outside) {
    const auto held = octoskin::converse(dialogue, socket, outside);
    if (!held) return unexpected(held.error());
    return *dialogue.outcome();
}

rig::SensorEdit edit_of(const Question& question, const wire::Calibration& found) {
    const bool is_offset = question.quantity == wire::CalibrationQuantity::offset;
    return {.node = question.node_name,
            .sensor = question.sensor_name,
            .key = is_offset ? "device_offset_mm" : "crosstalk_kcps",
            .value = is_offset ? fmt::format("{:.2f}", found.offset_quarter_mm / 4.0)
                               : fmt::format("{:.6f}", found.crosstalk_raw / 512.0)};
}

Result<std::filesystem::path, AppError> write_into_rig(const std::filesystem::path& rig,
                                                       const rig::SensorEdit& edit) {
    const auto save = [](const FilePlace& file, const std::string& text) -> std::optional<std::string> {
        std::error_code error;
        FilePlace itself = file;  // a file of a recording is never reached through a link
        if (file.folder() == nullptr) itself = std::filesystem::canonical(file.name(), error);
        if (error) return error.message();
        const auto saved =
            save_atomically(itself, text, posix_file_operations(), Attributes::of_the_old_file);
        return saved ? std::nullopt : std::optional(to_error(saved.error()).reason());
    };
    const auto file = rig::edit_sensor(rig, edit, save);
    if (!file) return fail(ExitCode::cannot_create, file.error());
    return *file;
}

}  // namespace octoskin::calibrating
