// A data set of depth images and camera poses, as a source of depth frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/tum/depth_units.hpp"
#include "host/io/tum/trajectory.hpp"
#include "hw/rigfile/data_set_depth.hpp"

namespace octoskin::tum {

/// Every value that a pixel can have, in millimetres to the nearest one; 0 for no value, and for more than a
/// depth frame holds, 65.535 m.
[[nodiscard]] std::vector<std::uint16_t> depth_mm_table(const rig::DataSetDepth& scale);

class DataSetReader final : public DepthSource {
  public:
    struct Paths {
        std::filesystem::path folder;
        [[nodiscard]] std::filesystem::path images() const { return folder / "depth.txt"; }
        [[nodiscard]] std::filesystem::path poses() const { return folder / "groundtruth.txt"; }
    };

    /// Reads both lists; `scale`: of the images. The folder is opened once: lists and images are files below
    /// it, behind no link. Errors name file and line: no list, an image before its predecessor, an image
    /// whose name leads elsewhere.
    [[nodiscard]] static Result<DataSetReader, DepthSourceError> open(const std::filesystem::path& folder,
                                                                      const rig::DataSetDepth& scale = {});

    /// The next image that has a pose; the others are counted. Its frame says where the camera was. An error
    /// names the image and its line in depth.txt, and is the same for ever.
    [[nodiscard]] Result<std::optional<DepthFrame>, DepthSourceError> next() override;

    /// Of the images read.
    [[nodiscard]] const PixelValues& values() const noexcept { return values_; }
    [[nodiscard]] std::uint64_t images_read() const noexcept { return images_read_; }
    [[nodiscard]] std::uint64_t images_without_pose() const noexcept { return images_without_pose_; }
    /// Lines of groundtruth.txt that were left out, as the pose above them has their time.
    [[nodiscard]] std::uint64_t poses_repeated() const noexcept { return trajectory_.repeated(); }
    /// Of images that are neither read nor counted yet.
    [[nodiscard]] std::uint64_t images_left() const noexcept { return images_.size() - next_; }
    /// When the first image was made; empty if there is none.
    [[nodiscard]] std::optional<HostTime> begin() const;
    /// Both lists and every image of depth.txt: what the data set measured.
    [[nodiscard]] std::vector<FilePlace> files() const;
    /// The first image of depth.txt, with its line and a remedy, that is not there or may not be read; empty
    /// if none is missing.
    [[nodiscard]] std::optional<DepthSourceError> missing_image() const;

  private:
    struct Image {
        std::uint64_t line = 0;
        ImageLine named;
    };
    DataSetReader(Paths paths, NamedFolder folder, Trajectory trajectory, const rig::DataSetDepth& scale)
        : paths_(std::move(paths)),
          folder_(std::move(folder)),
          trajectory_(std::move(trajectory)),
          depth_mm_(depth_mm_table(scale)) {}

    Paths paths_;         ///< for messages and for provenance
    NamedFolder folder_;  ///< that all is read from
    Trajectory trajectory_;
    std::vector<std::uint16_t> depth_mm_;  ///< of each value of a pixel
    PixelValues values_;
    std::vector<Image> images_;
    std::size_t next_ = 0;
    std::uint64_t images_read_ = 0;
    std::uint64_t images_without_pose_ = 0;
};

}  // namespace octoskin::tum
