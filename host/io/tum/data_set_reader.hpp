// A data set of depth images and camera poses, as a source of depth frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/tum/data_set_files.hpp"
#include "host/io/tum/depth_units.hpp"
#include "host/io/tum/trajectory.hpp"
#include "hw/rigfile/data_set_depth.hpp"

namespace octoskin::tum {

/// Every value that a pixel can have, in millimetres to the nearest one; 0 for no value, and for more than a
/// depth frame holds, 65.535 m.
[[nodiscard]] std::vector<std::uint16_t> depth_mm_table(const rig::DataSetDepth& scale);

/// Of the images about which there is no pose, the first.
struct FirstWithoutPose {
    DepthSourceError image;  ///< which one, with its line
    HostTime captured;
    std::optional<Nanoseconds> gap;  ///< between the poses about it; empty: before the first, after the last
};

/// What became of the lines that name images, or of the images if there is no list.
struct ImageCounts {
    std::uint64_t read = 0;
    std::uint64_t without_pose = 0;
    std::optional<FirstWithoutPose> first_without_pose;
    BadLines bad;
    std::uint64_t unordered = 0;               ///< of all: earlier than the one above; they are put in order
    std::optional<DepthSourceError> disorder;  ///< the first of them
};

class DataSetReader final : public DepthSource {
  public:
    /// Reads lists and poses; `keys`: in place of what the layout says. The folder is opened once: all is
    /// below it, behind no link. Errors name file and line: no images, no poses, an image whose name leads
    /// elsewhere.
    [[nodiscard]] static Result<DataSetReader, DepthSourceError> open(const std::filesystem::path& folder,
                                                                      const rig::DataSetKeys& keys = {});

    /// The next image that has a pose, by time; the others are counted. Its frame says where the camera was.
    /// An error names the image and its line, and is the same for ever.
    [[nodiscard]] Result<std::optional<DepthFrame>, DepthSourceError> next() override;

    [[nodiscard]] const DataSetLayout& layout() const noexcept { return *files_.layout; }
    /// Of the images' values.
    [[nodiscard]] const rig::DataSetDepth& scale() const noexcept { return scale_; }
    /// Of the images read.
    [[nodiscard]] const PixelValues& values() const noexcept { return values_; }
    [[nodiscard]] const ImageCounts& images() const noexcept { return counts_; }
    [[nodiscard]] const PoseCounts& poses() const noexcept { return trajectory_.counts(); }
    /// Between poses farther apart there is none.
    [[nodiscard]] Nanoseconds pose_gap_max() const noexcept { return trajectory_.gap_max(); }
    /// Of images that are neither read nor counted yet.
    [[nodiscard]] std::uint64_t images_left() const noexcept { return images_.size() - next_; }
    /// When the first image was made.
    [[nodiscard]] HostTime begin() const { return images_.front().named.captured; }
    [[nodiscard]] FilePlace first_image() const { return {folder_, images_.front().named.file}; }
    /// That the data set has of its own.
    [[nodiscard]] std::optional<FilePlace> calibration() const;
    /// Lists, poses, calibration and every image: what the data set measured.
    [[nodiscard]] std::vector<FilePlace> files() const;
    /// The first image, with its line and a remedy, that is not there or may not be read; empty if none is
    /// missing.
    [[nodiscard]] std::optional<DepthSourceError> missing_image() const;

  private:
    struct Image {
        std::uint64_t line = 0;  ///< of the list; 0: there is none
        ImageLine named;
    };
    DataSetReader(NamedFolder folder, DataSetFiles files, Trajectory trajectory,
                  const rig::DataSetDepth& scale)
        : folder_(std::move(folder)),
          files_(std::move(files)),
          trajectory_(std::move(trajectory)),
          scale_(scale),
          depth_mm_(depth_mm_table(scale)) {}
    [[nodiscard]] Status<DepthSourceError> read_list();
    [[nodiscard]] DepthSourceError about(const Image& image, const std::string& what) const;
    void count_without_pose(const Image& image);

    NamedFolder folder_;  ///< that all is read from
    DataSetFiles files_;
    Trajectory trajectory_;
    rig::DataSetDepth scale_;
    std::vector<std::uint16_t> depth_mm_;  ///< of each value of a pixel
    PixelValues values_;
    std::vector<Image> images_;  ///< never empty, by time
    std::size_t next_ = 0;
    ImageCounts counts_;
};

}  // namespace octoskin::tum
