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

/// Why a file cannot belong to the data set: its name leads out of the folder, or to a link. Whether it
/// exists and is an image is checked later.
std::optional<Error> elsewhere_fault(const FilePlace& image) {
    const auto opened = image.open();
    if (opened) return std::nullopt;
    const FolderFault fault = opened.error().fault;
    if (fault != FolderFault::link && fault != FolderFault::outside) return std::nullopt;
    return to_error(opened.error());
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

Result<DataSetReader, Error> DataSetReader::open(const std::filesystem::path& folder,
                                                 const rig::DataSetKeys& keys) {
    const NamedFolder opened(folder);
    auto files = find_data_set(opened);
    if (!files) return unexpected(files.error());
    const Nanoseconds gap_max{std::llround(1e6 * keys.pose_gap_max_ms)};
    auto trajectory = files->poses.empty()
                          ? Trajectory::read_frames(opened, files->frames, gap_max)
                          : Trajectory::read({opened, files->poses}, gap_max, files->layout->axes);
    if (!trajectory) return unexpected(trajectory.error());
    DataSetReader reader(opened, std::move(*files), std::move(*trajectory), keys.depth(files->layout->depth));
    if (const auto read = reader.read_list(); !read) return unexpected(read.error());
    for (const Image& image : reader.images_) {
        if (auto elsewhere = elsewhere_fault({opened, image.named.file}))
            return unexpected(reader.about(image, *elsewhere));
    }
    return reader;
}

Status<Error> DataSetReader::read_list() {
    for (const NumberedFrame& frame : files_.frames) images_.push_back({0, {frame.captured, frame.image}});
    if (files_.images.empty()) return Done{};
    const FilePlace list(folder_, files_.images);
    const auto take = [&](std::uint64_t number, std::string_view line) -> Status<std::string> {
        auto image = parse_image_line(line);
        if (!image) return unexpected(image.error());
        const bool is_unordered = !images_.empty() && image->captured < images_.back().named.captured;
        if (is_unordered && counts_.unordered++ == 0)
            counts_.disorder =
                line_error(list.shown(), number,
                           {ErrorCode::bad_value, "its time is before that of the image above it"});
        images_.push_back({number, std::move(*image)});
        return Done{};
    };
    auto bad = read_lines(list, take);
    if (!bad) return unexpected(bad.error());
    if (images_.empty() && bad->first) return unexpected(*bad->first);
    if (images_.empty()) {
        return unexpected(
            in_file({ErrorCode::no_content, "it names no image: expected lines of TIME FILE"}, list.shown()));
    }
    counts_.bad = std::move(*bad);
    std::ranges::stable_sort(images_, {}, [](const Image& image) { return image.named.captured; });
    return Done{};
}

Error DataSetReader::about(const Image& image, Error error) const {
    const std::filesystem::path& folder = folder_.shown();
    if (image.line == 0) return in_file(std::move(error), folder / image.named.file);
    error.key = image.named.file;
    return line_error(folder / files_.images, image.line, std::move(error));
}

void DataSetReader::count_without_pose(const Image& image) {
    if (counts_.without_pose++ > 0) return;
    const HostTime captured = image.named.captured;
    counts_.first_without_pose = FirstWithoutPose{about(image, {ErrorCode::no_data, "no pose near its time"}),
                                                  captured, trajectory_.gap_about(captured)};
}

Result<std::optional<DepthFrame>, Error> DataSetReader::next() {
    for (; next_ < images_.size(); ++next_) {
        const Image& next = images_[next_];
        const auto T_map_camera = trajectory_.at(next.named.captured);
        if (!T_map_camera) {
            count_without_pose(next);
            continue;
        }
        const auto image = read_depth_png({folder_, next.named.file});
        if (!image) return unexpected(about(next, {ErrorCode::bad_syntax, image.error()}));
        ++next_;
        ++counts_.read;
        values_.add(image->values);
        DepthFrame frame{next.named.captured, image->width, image->height, {}, T_map_camera};
        frame.depth_mm.reserve(image->values.size());
        std::transform(image->values.begin(), image->values.end(), std::back_inserter(frame.depth_mm),
                       [this](std::uint16_t value) { return depth_mm_[value]; });
        return std::optional(std::move(frame));
    }
    return std::optional<DepthFrame>{};
}

std::optional<FilePlace> DataSetReader::calibration() const {
    return files_.calibration.empty() ? std::nullopt : std::optional(FilePlace(folder_, files_.calibration));
}

std::vector<FilePlace> DataSetReader::files() const {
    std::vector<FilePlace> files;
    for (const std::string& name : {files_.images, files_.poses, files_.calibration}) {
        if (!name.empty()) files.emplace_back(folder_, name);
    }
    for (const Image& image : images_) files.emplace_back(folder_, image.named.file);
    for (const NumberedFrame& frame : files_.frames) {
        if (frame.has_pose) files.emplace_back(folder_, frame.pose);
    }
    return files;
}

std::optional<Error> DataSetReader::missing_image() const {
    for (const Image& image : images_) {
        const auto opened = FilePlace(folder_, image.named.file).open();
        if (opened) continue;
        const FolderFault fault = opened.error().fault;
        Error error = to_error(opened.error());
        if (fault == FolderFault::not_permitted) {
            error.what = "there is no permission to read it";
            error.remedy = "change its permissions";
        } else if (fault == FolderFault::absent) {
            error.what = "does not exist";
            error.remedy = "unpack the data set again, or remove the line";
        }
        return about(image, std::move(error));
    }
    return std::nullopt;
}

}  // namespace octoskin::tum
