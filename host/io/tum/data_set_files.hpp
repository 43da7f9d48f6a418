// Finds the files of a data set in a folder, in the layouts in which depth images with poses are published.
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

/// The direction of the y axis of camera and map in a trajectory: down, as in the optical frame; or up, where
/// both frames are left-handed.
enum class CameraAxes : std::uint8_t { y_down, y_up };

/// The publisher's conventions, used if neither a rig nor an option overrides them.
struct DataSetLayout {
    std::string_view name;
    std::string_view poses;   ///< the trajectory's name, or the end of it after a '*'
    std::string_view camera;  ///< one of kDataSetCameras
    rig::DataSetDepth depth;
    CameraAxes axes = CameraAxes::y_down;
};

/// "frame-000012.depth.png". These data sets contain no times: 30 frames a second are assumed.
struct NumberedFrame {
    HostTime captured;
    std::string image;
    std::string pose;
    bool has_pose = false;  ///< its pose file exists
};

struct DataSetFiles {
    const DataSetLayout* layout = nullptr;
    std::string images;                 ///< the list of images; empty: `frames`
    std::string poses;                  ///< the trajectory; empty: `frames`
    std::string calibration;            ///< empty: none
    std::vector<NumberedFrame> frames;  ///< ordered by number
};

/// The list of the folder's depth images, as the user knows it: a list's name, or "frame-*.depth.png". Empty:
/// the folder is not a data set.
[[nodiscard]] std::optional<std::string> depth_images_of(const NamedFolder& folder);

/// The files of a folder that has depth images. An error names what is missing or ambiguous.
[[nodiscard]] Result<DataSetFiles, Error> find_data_set(const NamedFolder& folder);

}  // namespace octoskin::tum
