// Which files of a folder are a data set's: the layouts in which people publish depth images with poses.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/data_set_depth.hpp"

namespace octoskin::tum {

/// Which way the y axis of camera and map points in a trajectory: the optical frame's downwards; or upwards,
/// with which both are left-handed.
enum class CameraAxes : std::uint8_t { y_down, y_up };

/// What is as the data set's publisher has it, if neither a rig nor an option says otherwise.
struct DataSetLayout {
    std::string_view name;
    std::string_view poses;   ///< the trajectory's name, or how it ends after a '*'
    std::string_view camera;  ///< one of kDataSetCameras
    rig::DataSetDepth depth;
    CameraAxes axes = CameraAxes::y_down;
};

/// "frame-000012.depth.png": 30 of them are a second, as no time is told.
struct NumberedFrame {
    HostTime captured;
    std::string image;
    std::string pose;
    bool has_pose = false;  ///< the file of its pose is there
};

struct DataSetFiles {
    const DataSetLayout* layout = nullptr;
    std::string images;                 ///< the list of them; empty: `frames`
    std::string poses;                  ///< the trajectory; empty: `frames`
    std::string calibration;            ///< empty: none
    std::vector<NumberedFrame> frames;  ///< in order of their numbers
};

/// What the folder lists its depth images by, as a user would call it: a list's name, or "frame-*.depth.png".
/// Empty: it is no data set.
[[nodiscard]] std::optional<std::string> depth_images_of(const NamedFolder& folder);

/// The files of a folder that has depth images. An error says what is missing, or there twice.
[[nodiscard]] Result<DataSetFiles, DepthSourceError> find_data_set(const NamedFolder& folder);

}  // namespace octoskin::tum
