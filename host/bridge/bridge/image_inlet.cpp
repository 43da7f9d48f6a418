#include "host/bridge/bridge/image_inlet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "host/bridge/bridge/stamp_text.hpp"
#include "host/bridge/cdr/cdr_reader.hpp"
#include "host/bridge/published/ros_values.hpp"

namespace octoskin::bridge {
namespace {

/// A quarter of a second at 30 Hz: this thread may be busy with a map. Older images are of no use (`behind`).
constexpr std::int32_t kImagesKept = 8;
constexpr Nanoseconds kStartPatience{5'000'000'000};

constexpr std::size_t kInfoBytesMax = std::size_t{64} << 10U;
/// With two publishers of one topic at once, which of them is the rig's camera cannot be decided.
constexpr Nanoseconds kAtOnce{1'000'000'000};

/// Four bytes a pixel, in rows with some bytes more.
std::size_t image_bytes_max(const CameraFacts& camera) {
    constexpr std::size_t kMore = std::size_t{256} << 10U;
    return std::size_t{camera.intrinsics.width} * camera.intrinsics.height * 8 + kMore;
}

ros::TypeName image_type(const std::string& topic) {
    return is_compressed(topic) ? ros::sensor_msgs::CompressedImage::kType : ros::sensor_msgs::Image::kType;
}

}  // namespace

ImageInlet::ImageInlet(const dds::Participant& participant, CameraFacts camera, std::filesystem::path control)
    : camera_(std::move(camera)),
      images_(participant, camera_.topic().value(), image_type(camera_.topic().value()),
              dds::Durability::volatile_, kImagesKept, image_bytes_max(camera_)),
      info_(participant, info_topic(camera_.topic().value()), ros::sensor_msgs::CameraInfo::kType,
            dds::Durability::transient_local, 1, kInfoBytesMax),
      sender_(std::move(control), camera_.name, camera_.rate_hz) {}

void ImageInlet::attend(const std::vector<dds::Endpoint>& writers, HostTime now) {
    if (!begun_) begun_ = now;
    images_.attend(writers);
    info_.attend(writers);
}

void ImageInlet::take(const std::function<Arrival(const dds::Sample&)>& arrival_of) {
    for (const dds::Sample& sample : info_.take(8)) take_info(sample);
    for (const dds::Sample& sample : images_.take(kImagesKept)) take_image(sample, arrival_of(sample));
}

bool ImageInlet::has_rival(std::uint64_t publisher, HostTime now) {
    std::erase_if(publishers_at_, [now](const auto& one) { return now - one.second > kAtOnce; });
    publishers_at_[publisher] = now;
    return publishers_at_.size() > 1;
}

void ImageInlet::take_info(const dds::Sample& sample) {
    const auto info = cdr::read<ros::sensor_msgs::CameraInfo>(sample.bytes);
    info_problem_ = info ? differs_from_rig(*info, camera_.intrinsics, images_.topic())
                         : std::string("its camera_info ") + cdr::describe(info.error());
    is_info_right_ = info_problem_.empty();
}

void ImageInlet::count(ImageFault fault) {
    switch (fault) {
        case ImageFault::encoding:
            ++counts_.encoding;
            break;
        case ImageFault::wrong_size:
            ++counts_.wrong_size;
            break;
        case ImageFault::short_data:
            ++counts_.short_data;
            break;
    }
}

void ImageInlet::take_image(const dds::Sample& sample, const Arrival& arrival) {
    ++counts_.received;
    WallTime stamp;
    const auto pixels_of = [&](const auto& message) -> std::optional<DepthPixels> {
        if (!message) {
            ++counts_.malformed;
            return std::nullopt;
        }
        stamp = wall_time_of(message->header.stamp);
        auto pixels = depth_pixels(*message, camera_.intrinsics.width, camera_.intrinsics.height);
        if (pixels) return std::move(pixels).value();
        count(pixels.error());
        return std::nullopt;
    };
    auto pixels = is_compressed(images_.topic())
                      ? pixels_of(cdr::read<ros::sensor_msgs::CompressedImage>(sample.bytes))
                      : pixels_of(cdr::read<ros::sensor_msgs::Image>(sample.bytes));
    if (!pixels) return;
    if (!is_info_right_) {
        ++counts_.no_camera_info;
        return;
    }
    if (has_rival(sample.writer, arrival.monotonic)) {
        ++counts_.second_sender;
        return;
    }
    const auto captured = time_of_stamp(stamp, arrival);
    if (!captured) {
        ++(captured.error() == StampFault::ahead ? counts_.ahead : counts_.behind);
        stamp_age_ = Nanoseconds{arrival.wall.ns - stamp.ns};
        return;
    }
    const bool has_clock_gone_back = newest_stamp_.ns > arrival.wall.ns + kAheadMax.count();
    if (stamp.ns != 0 && stamp <= newest_stamp_ && !has_clock_gone_back) {
        ++counts_.still;
        return;
    }
    newest_stamp_ = stamp;
    sender_.send(*captured, std::move(*pixels));
    ++counts_.forwarded;
}

ImageCounts ImageInlet::counts() const {
    ImageCounts counts = counts_;
    counts.lost = images_.lost();
    return counts;
}

std::vector<std::string> ImageInlet::problems(HostTime now) const {
    std::vector<std::string> problems;
    const std::string on = camera_.name.empty() ? "the camera: " : "camera '" + camera_.name + "': ";
    const bool is_late = begun_ && now - *begun_ > kStartPatience;
    if (images_.publishers() == 0 && is_late)
        problems.push_back(
            on + (images_.other_type().empty()
                      ? fmt::format("nothing publishes {}: start its driver, or correct 'device' in the rig",
                                    images_.topic())
                      : fmt::format(
                            "{} has messages of type {}: 'device' in the rig needs a topic of depth images",
                            images_.topic(), images_.other_type())));
    if (!info_problem_.empty()) problems.push_back(on + info_problem_);
    if (images_.publishers() > 0 && !is_info_right_ && info_problem_.empty() && is_late)
        problems.push_back(on + "nothing publishes " + info_.topic() +
                           ", which is needed to use its images: start its driver");
    if (lately_.gained(&ImageCounts::wrong_size) > 0 && info_problem_.empty())
        problems.push_back(
            on + fmt::format("the images of {} have another size than the rig's {} x {}: correct the "
                             "rig's camera, or set the driver to this size",
                             images_.topic(), camera_.intrinsics.width, camera_.intrinsics.height));
    if (lately_.gained(&ImageCounts::encoding) > 0)
        problems.push_back(on +
                           fmt::format("the images of {} are no depth images: 16UC1, mono16 or 32FC1 (or "
                                       "compressedDepth png of 16UC1) are needed",
                                       images_.topic()));
    if (std::string text = stamp_problem(
            "its images", lately_.gained(&ImageCounts::ahead) + lately_.gained(&ImageCounts::behind),
            lately_.gained(&ImageCounts::received), stamp_age_);
        !text.empty())
        problems.push_back(on + text);
    if (lately_.gained(&ImageCounts::second_sender) > 0)
        problems.push_back(on + fmt::format("two programs publish {}: end one of them", images_.topic()));
    if (lately_.gained(&ImageCounts::still) > 0 && lately_.gained(&ImageCounts::forwarded) == 0)
        problems.push_back(on + "the stamps of its images do not advance: they are not used");
    const FrameSenderRecord sender = sender_.record();
    if (counts_.forwarded > 0 && !sender.is_connected && !sender.why.empty())
        problems.push_back(on + sender.why);
    return problems;
}

}  // namespace octoskin::bridge
