// Calibrates one sensor over a CAN interface.
#pragma once

#include <filesystem>
#include <string>

#include "host/apps/calibration/dialogue.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/sensor_edit.hpp"

namespace octoskin::calibrating {

/// The user's request, by names.
struct Wish {
    std::string node;  ///< name or number; empty if the rig has only one node
    std::string sensor;
    wire::CalibrationQuantity quantity = wire::CalibrationQuantity::offset;
    std::uint16_t target_mm = 0;
};

/// Looks up the node and the sensor in the rig. Error, always `usage`: no such node or sensor; the message
/// lists those of the rig.
[[nodiscard]] Result<Question, AppError> question_of(const rig::Rig& rig, const Wish& wish,
                                                     std::uint8_t sequence);

/// Blocks until the dialogue ends. Errors: those of the dialogue, and a CAN interface that does not work.
[[nodiscard]] Dialogue::Outcome converse(Dialogue& dialogue, socketcan::CanSocket& socket,
                                         const Outside& outside);

/// The change that stores the result `found` in the rig file: `device_offset_mm` (millimetres) or
/// `crosstalk_kcps`.
[[nodiscard]] rig::SensorEdit edit_of(const Question& question, const wire::Calibration& found);

/// Writes the change atomically: at every instant the rig file is either the old one or the new one. The file
/// keeps its mode, and its owner where that is permitted. If the path is a symbolic link, its target is
/// replaced, not the link. Returns the changed file, which may be one that the rig extends. Error:
/// `cannot_create`.
[[nodiscard]] Result<std::filesystem::path, AppError> write_into_rig(const std::filesystem::path& rig,
                                                                     const rig::SensorEdit& edit);

}  // namespace octoskin::calibrating
