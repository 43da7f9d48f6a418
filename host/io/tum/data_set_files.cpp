#include "host/io/tum/data_set_files.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace octoskin::tum {
namespace {

/// depth.txt is the list of the TUM RGB-D benchmark and of ETH3D. The other lists also contain the colour
/// images, like that of ICL-NUIM and the output of the benchmark's associate.py.
constexpr std::array<std::string_view, 5> kImageLists{"depth.txt", "associations.txt", "associated.txt",
                                                      "association.txt", "associate.txt"};
/// That of ETH3D: fx fy cx cy. That of frames with a pose file each: a 3 x 3 matrix.
constexpr std::array<std::string_view, 2> kCalibrations{"calibration.txt", "camera-intrinsics.txt"};

constexpr std::string_view kFramePrefix = "frame-";
constexpr std::string_view kFrameImage = ".depth.png";
constexpr std::string_view kFramePose = ".pose.txt";
constexpr const char* kFrameImages = "frame-*.depth.png";

/// Sources: cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats, www.eth3d.net/slam_documentation,
/// www.doc.ic.ac.uk/~ahanda/VaFRIC (camera frame: x right, y up, z forward),
/// www.microsoft.com/en-us/research/project/rgb-d-dataset-7-scenes.
constexpr std::array<DataSetLayout, 3> kLayouts{{
    {.name = "TUM RGB-D", .poses = "groundtruth.txt", .camera = "kinect", .depth = {5000.0, 0}},
    {.name = "ICL-NUIM",
     .poses = "*.gt.freiburg",
     .camera = "icl_nuim",
     .depth = {5000.0, 0},
     .axes = CameraAxes::y_up},
    {.name = "7-Scenes", .poses = "frame-*.pose.txt", .camera = "seven_scenes", .depth = {1000.0, 65'535}},
}};
constexpr const DataSetLayout& kOfFrames = kLayouts.back();

std::vector<std::string> names_in(const NamedFolder& folder) {
    const auto opened = folder.open();
    if (!opened) return {};
    auto names = opened->names();
    return names ? std::move(*names) : std::vector<std::string>{};
}

/// A file, or a link of that name, which is refused when it is opened.
bool is_there(const NamedFolder& folder, std::string_view name) {
    const EntryKind kind = FilePlace(folder, std::string(name)).kind();
    return kind == EntryKind::file || kind == EntryKind::link;
}

template <std::size_t N>
std::string first_there(const NamedFolder& folder, const std::array<std::string_view, N>& names) {
    const auto found =
        std::ranges::find_if(names, [&](std::string_view name) { return is_there(folder, name); });
    return found == names.end() ? std::string() : std::string(*found);
}

/// The number in "frame-000012.depth.png"; empty for any other name.
std::optional<std::int64_t> frame_number(std::string_view name) {
    constexpr std::int64_t kNumberMax = 1'000'000'000;
    if (!name.starts_with(kFramePrefix) || !name.ends_with(kFrameImage)) return std::nullopt;
    const std::size_t digits = name.size() - std::min(name.size(), kFramePrefix.size() + kFrameImage.size());
    const std::string_view text = name.substr(kFramePrefix.size(), digits);
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = error == std::errc{} && end == text.data() + text.size();
    return is_number && number >= 0 && number <= kNumberMax ? std::optional(number) : std::nullopt;
}

std::vector<NumberedFrame> frames_of(const std::vector<std::string>& names) {
    std::vector<NumberedFrame> frames;
    for (const std::string& name : names) {
        const auto number = frame_number(name);
        if (!number) continue;
        std::string pose = name.substr(0, name.size() - kFrameImage.size()) + std::string(kFramePose);
        const bool has_pose = std::ranges::binary_search(names, pose);
        frames.push_back({HostTime{*number * 1'000'000'000 / 30}, name, std::move(pose), has_pose});
    }
    std::ranges::stable_sort(frames, {}, &NumberedFrame::captured);
    return frames;
}

/// The existing ones; a pattern is compared with the end of a name.
std::vector<std::string> trajectories(const std::vector<std::string>& names, std::string_view poses) {
    std::vector<std::string> found;
    const bool is_pattern = poses.starts_with('*');
    for (const std::string& name : names) {
        if (is_pattern ? name.ends_with(poses.substr(1)) : name == poses) found.push_back(name);
    }
    return found;
}

}  // namespace

std::optional<std::string> depth_images_of(const NamedFolder& folder) {
    if (std::string list = first_there(folder, kImageLists); !list.empty()) return list;
    const bool has_frames = std::ranges::any_of(
        names_in(folder), [](const std::string& name) { return frame_number(name).has_value(); });
    return has_frames ? std::optional<std::string>(kFrameImages) : std::nullopt;
}

Result<DataSetFiles, Error> find_data_set(const NamedFolder& folder) {
    const std::vector<std::string> names = names_in(folder);
    DataSetFiles files{.layout = &kLayouts.front(),
                       .images = first_there(folder, kImageLists),
                       .poses = std::string(kLayouts.front().poses),
                       .calibration = first_there(folder, kCalibrations),
                       .frames = {}};
    if (files.images.empty()) {
        files.frames = frames_of(names);
        files.layout = &kOfFrames;
        files.poses.clear();
        return files;
    }
    for (const DataSetLayout& layout : kLayouts) {
        const auto found = trajectories(names, layout.poses);
        if (found.size() > 1) {
            return unexpected(Error{.code = ErrorCode::conflict,
                                    .what = "has " + found[0] + " and " + found[1],
                                    .remedy = "move away those that do not belong to these images",
                                    .file = folder.shown()});
        }
        if (found.empty()) continue;
        files.layout = &layout;
        files.poses = found.front();
        break;
    }
    return files;
}

}  // namespace octoskin::tum
