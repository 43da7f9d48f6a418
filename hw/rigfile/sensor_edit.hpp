// Writes what was found of one sensor into the rig file that a person keeps: comments, order and layout stay.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

struct SensorEdit {
    std::string node;    ///< its name
    std::string sensor;  ///< its name
    std::string key;
    std::string value;  ///< as YAML
};

/// The text of a rig file in which the sensor's key has the value: replaced where it stood, or added after
/// the name. Empty if the text is no YAML or has no such sensor written out (the file that it extends may
/// have).
[[nodiscard]] std::optional<std::string> edited(const std::string& text, const SensorEdit& edit);

/// Puts `text` in the place of all that the file holds, whole or not at all; else says why not.
using SaveText = std::function<std::optional<std::string>(const FilePlace& file, const std::string& text)>;

/// Edits the rig's file, or the one it extends in which the sensor stands; returns which. The rig is read
/// again afterwards and must be what it was but for that one value, else the file is put back as it was.
/// Errors: no file has the sensor, `save` fails, or the rig would not be a rig any more.
[[nodiscard]] Result<std::filesystem::path, RigError> edit_sensor(const std::filesystem::path& file,
                                                                  const SensorEdit& edit,
                                                                  const SaveText& save);

}  // namespace octoskin::rig
