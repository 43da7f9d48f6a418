// Calibrates one sensor over a CAN interface.
#pragma once

#include <filesystem>
#include <string>

#include "host/apps/calibrating/dialogue.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/sensor_edit.hpp"

namespace octoskin::calibrating {

/// What a person asks for, by name.
struct Wish {
    std::string node;  ///< name or number; empty if the rig has one only
    std::string sensor;
    wire::CalibrationQuantity quantity = wire::CalibrationQuantity::offset;
    std::uint16_t target_mm = 0;
};

/// Errors, all `usage`: no such node or sensor, naming those there are.
[[nodiscard]] Result<Question, AppError> question_of(const rig::Rig& rig, const Wish& wish,
                                                     std::uint8_t sequence);

/// Blocks until the dialogue has ended. Errors: its own, and a CAN interface that does not work.
[[nodiscard]] Dialogue::Outcome converse(Dialogue& dialogue, socketcan::CanSocket& socket,
                                         const Outside& outside);

/// What to write into the rig.
[[nodiscard]] rig::SensorEdit edit_of(const Question& question, const wire::Calibration& found);

/// Writes it, atomically: at every instant the rig's file is the old one or the new one. Its mode stays, and
/// its owner where that is permitted; what a symbolic link stands for is replaced, not the link. Returns the
/// file that was changed, which may be one that the rig extends. Error: `cannot_create`.
[[nodiscard]] Result<std::filesystem::path, AppError> write_into_rig(const std::filesystem::path& rig,
                                                                     const rig::SensorEdit& edit);

}  // namespace octoskin::calibrating
