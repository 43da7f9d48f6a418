// Writes one value of a sensor into a hand-written rig file: comments, order and layout are kept.
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

/// The text of a rig file with the sensor's key set to the value: replaced in place, or added after the name.
/// Empty if the text is not YAML or does not contain the sensor (the file that it extends may).
[[nodiscard]] std::optional<std::string> edited(const std::string& text, const SensorEdit& edit);

/// Replaces the content of the file by `text` atomically. Returns the reason if it fails.
using SaveText = std::function<std::optional<std::string>(const FilePlace& file, const std::string& text)>;

/// Edits the rig's file, or the extended file that contains the sensor; returns its path. Reads the rig again
/// afterwards: it must differ in that one value only, else the file is restored. Errors: no file has the
/// sensor, `save` fails, or the edited rig is not valid.
[[nodiscard]] Result<std::filesystem::path, Error> edit_sensor(const std::filesystem::path& file,
                                                               const SensorEdit& edit, const SaveText& save);

}  // namespace octoskin::rig
