#include "host/io/tum/data_set_reader.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <system_error>

#include "host/io/tum/depth_png.hpp"
#include "host/io/tum/line_file.hpp"

namespace octoskin::tum {
namespace {

/// Why a file is none of the data set's: its name leads out of the folder, or to a link. Whether it is there,
/// and an image, shows later.
std::optional<std::string> elsewhere_fault(const FilePlace& image) {
    const auto opened = image.open();
    if (opened) return std::nullopt;
    const FolderFault fault = opened.error().fault;
    if (fault != FolderFault::link && fault != FolderFault::outside) return std::nullopt;
    return opened.error().reason();
}

}  // namespace

std::vector<std::uint16_t> depth_mm_table(const rig::DataSetDepth& scale) {
    assert(scale.units_per_m > 0.0);
    constexpr unsigned kValueMax = std::numeric_limits<std::uint16_t>::max();
    std::vector<std::uint16_t> table(kValueMax + 1U, 0);
    for (unsigned value = 0; value <= kValueMax; ++value) {
        const double depth_mm = std::round(1000.0 * value / scale.units_per_m);
        if (value != scale.no_value && depth_mm <= kValueMax)
            table[value] = static_cast<std::uint16_t>(depth_mm);
    }
    return table;
}

Result<DataSetReader, DepthSourceError> DataSetReader::open(const std::filesystem::path& folder,
                                                            const rig::DataSetDepth& scale) {
    const NamedFolder opened(folder);
    auto trajectory = Trajectory::read({opened, "groundtruth.txt"});
    if (!trajectory) return unexpected(trajectory.error());
    DataSetReader reader(Paths{folder}, opened, std::move(*trajectory), scale);
    std::vector<Image>& images = reader.images_;
    const auto take = [&images, &opened](std::uint64_t number, std::string_view line) -> Status<std::string> {
        auto image = parse_image_line(line);
        if (!image) return unexpected(image.error());
        if (!images.empty() && image->captured < images.back().named.captured)
            return unexpected(std::string("its time is before that of the image above it"));
        if (auto elsewhere = elsewhere_fault({opened, image->file}))
            return unexpected(image->file + ": " + *elsewhere);
        images.push_back({number, std::move(*image)});
        return Done{};
    };
    if (const auto done = read_lines({opened, "depth.txt"}, take); !done) return unexpected(done.error());
    if (images.empty()) {
        return unexpected(DepthSourceError{reader.paths_.images().string() +
                                           ": names no image: expected lines of TIME FILE"});
    }
    return reader;
}

Result<std::optional<DepthFrame>, DepthSourceError> DataSetReader::next() {
    for (; next_ < images_.size(); ++next_) {
        const auto& [line, named] = images_[next_];
        const auto T_map_camera = trajectory_.at(named.captured);
        if (!T_map_camera) {
            ++images_without_pose_;
            continue;
        }
        const auto image = read_depth_png({folder_, named.file});
        if (!image) return unexpected(line_error(paths_.images(), line, named.file + ": " + image.error()));
        ++next_;
        ++images_read_;
        values_.add(image->values);
        DepthFrame frame{named.captured, image->width, image->height, {}, T_map_camera};
        frame.depth_mm.reserve(image->values.size());
        std::transform(image->values.begin(), image->values.end(), std::back_inserter(frame.depth_mm),
                       [this](std::uint16_t value) { return depth_mm_[value]; });
        return std::optional(std::move(frame));
    }
    return std::optional<DepthFrame>{};
}

std::optional<HostTime> DataSetReader::begin() const {
    if (images_.empty()) return std::nullopt;
    return images_.front().named.captured;
}

std::vector<FilePlace> DataSetReader::files() const {
    std::vector<FilePlace> files{{folder_, "depth.txt"}, {folder_, "groundtruth.txt"}};
    for (const Image& image : images_) files.emplace_back(folder_, image.named.file);
    return files;
}

std::optional<DepthSourceError> DataSetReader::missing_image() const {
    for (const auto& [line, named] : images_) {
        const auto opened = FilePlace(folder_, named.file).open();
        if (opened) continue;
        const FolderFault fault = opened.error().fault;
        std::string what = opened.error().reason();
        if (fault == FolderFault::not_permitted) what = "may not be read: give yourself the right to";
        if (fault == FolderFault::absent)
            what = "is not there: unpack the data set anew, or take out the line";
        return line_error(paths_.images(), line, named.file + ": " + what);
    }
    return std::nullopt;
}

}  // namespace octoskin::tum
