// A data set of depth images and camera poses as a source of depth frames.
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

/// The depth for every value of a pixel, rounded to millimetres; 0 for no value, and for more than a depth
/// frame can hold, 65.535 m.
[[nodiscard]] std::vector<std::uint16_t> depth_mm_table(const rig::DataSetDepth& scale);

/// The first image without a pose.
struct FirstWithoutPose {
    Error image;  ///< the image, with its line
    HostTime captured;
    std::optional<Nanoseconds>
        gap;  ///< gap between the poses around it; empty: it is before the first or after the last pose
};

/// Counts of the lines that name images, or of the images if there is no list.
struct ImageCounts {
    std::uint64_t read = 0;
    std::uint64_t without_pose = 0;
    std::optional<FirstWithoutPose> first_without_pose;
    BadLines bad;
    std::uint64_t unordered = 0;    ///< of all: with a time before that of the previous line; they are sorted
    std::optional<Error> disorder;  ///< the first of them
};

class DataSetReader final : public DepthSource {
  public:
    /// Reads lists and poses. `keys` override the layout's conventions. The folder is opened once; all files
    /// are below it, and links are not followed. Errors name file and line: no images, no poses, an image
    /// whose name leads out of the folder.
    [[nodiscard]] static Result<DataSetReader, Error> open(const std::filesystem::path& folder,
                                                           const rig::DataSetKeys& keys = {});

    /// The next image with a pose, in order of time; images without one are counted. The frame contains the
    /// camera's pose. An error names the image and its line; every later call returns the same error.
    [[nodiscard]] Result<std::optional<DepthFrame>, Error> next() override;

    [[nodiscard]] const DataSetLayout& layout() const noexcept { return *files_.layout; }
    /// The scale of the image values.
    [[nodiscard]] const rig::DataSetDepth& scale() const noexcept { return scale_; }
    /// The values of the images read so far.
    [[nodiscard]] const PixelValues& values() const noexcept { return values_; }
    [[nodiscard]] const ImageCounts& images() const noexcept { return counts_; }
    [[nodiscard]] const PoseCounts& poses() const noexcept { return trajectory_.counts(); }
    /// The largest gap between poses that is interpolated.
    [[nodiscard]] Nanoseconds pose_gap_max() const noexcept { return trajectory_.gap_max(); }
    /// Number of images that are neither read nor counted yet.
    [[nodiscard]] std::uint64_t images_left() const noexcept { return images_.size() - next_; }
    /// The time of the first image.
    [[nodiscard]] HostTime begin() const { return images_.front().named.captured; }
    [[nodiscard]] FilePlace first_image() const { return {folder_, images_.front().named.file}; }
    /// The data set's own calibration file.
    [[nodiscard]] std::optional<FilePlace> calibration() const;
    /// All measurements of the data set: lists, poses, calibration and every image.
    [[nodiscard]] std::vector<FilePlace> files() const;
    /// The first image, with its line and a remedy, that does not exist or may not be read; empty if none is
    /// missing.
    [[nodiscard]] std::optional<Error> missing_image() const;

  private:
    struct Image {
        std::uint64_t line = 0;  ///< line of the list; 0: there is none
        ImageLine named;
    };
    DataSetReader(NamedFolder folder, DataSetFiles files, Trajectory trajectory,
                  const rig::DataSetDepth& scale)
        : folder_(std::move(folder)),
          files_(std::move(files)),
          trajectory_(std::move(trajectory)),
          scale_(scale),
          depth_mm_(depth_mm_table(scale)) {}
    [[nodiscard]] Status<Error> read_list();
    [[nodiscard]] Error about(const Image& image, Error error) const;
    void count_without_pose(const Image& image);

    NamedFolder folder_;  ///< the folder of all files
    DataSetFiles files_;
    Trajectory trajectory_;
    rig::DataSetDepth scale_;
    std::vector<std::uint16_t> depth_mm_;  ///< for each value of a pixel
    PixelValues values_;
    std::vector<Image> images_;  ///< never empty; ordered by time
    std::size_t next_ = 0;
    ImageCounts counts_;
};

}  // namespace octoskin::tum
