#include "host/bridge/mcap/bag_camera.hpp"

#include <algorithm>
#include <utility>

#include "host/bridge/mcap/bag_messages.hpp"
#include "host/bridge/mcap/bag_time.hpp"
#include "host/bridge/received/depth_image.hpp"

namespace octoskin::bridge {
namespace {

struct StampedPixels {
    WallTime stamp;
    DepthPixels pixels;
};

template <cdr::Message M>
Result<StampedPixels, const char*> pixels_as(const mcap::Message& message, const CameraFacts& camera) {
    const auto image = read_as<M>(message);
    if (!image) return unexpected(image.error());
    auto pixels = depth_pixels(*image, camera.intrinsics.width, camera.intrinsics.height);
    if (!pixels) return unexpected(name(pixels.error()));
    return StampedPixels{wall_time_of(image->header.stamp), std::move(pixels).value()};
}

Result<StampedPixels, const char*> pixels_of(const mcap::Message& message, const CameraFacts& camera) {
    return is_compressed(message.channel->topic)
               ? pixels_as<ros::sensor_msgs::CompressedImage>(message, camera)
               : pixels_as<ros::sensor_msgs::Image>(message, camera);
}

}  // namespace

BagCamera::BagCamera(CameraFacts camera, std::string topic, const ros::sensor_msgs::CameraInfo* info)
    : camera_(std::move(camera)),
      topic_(std::move(topic)),
      problem_(info != nullptr
                   ? differs_from_rig(*info, camera_.intrinsics, topic_)
                   : "the bag has no " + info_topic(topic_) + ", which is needed to use its images") {}

Status<Error> BagCamera::take(const mcap::Message& message, const RecordingPaths& paths,
                              const BusClock& clock, bool uses_log_time, TopicAccount& account) {
    const auto refuse = [&account](std::string_view reason) -> Status<Error> {
        account.note_rejected(reason);
        return Done{};
    };
    auto image = pixels_of(message, camera_);
    if (!image) return refuse(image.error());
    if (!problem_.empty()) return refuse("no_camera_info");
    const auto stamp = time_of(image->stamp, message.head.logged, uses_log_time);
    if (!stamp || !has_bus_time(clock, *stamp)) return refuse("stamp_off");
    const HostTime captured = clock.bus_of(*stamp);
    if (newest_ && captured <= *newest_) return refuse("still");
    newest_ = captured;
    if (!writer_) {
        if (!camera_.name.empty()) {
            const auto folder = paths.file(RecordingPaths::kDepthFolder).make_folder();
            if (!folder) return unexpected(to_error(folder.error()));
        }
        auto writer = openni2::OniWriter::create(paths.depth(camera_.name), paths.depth_epoch(camera_.name),
                                                 {camera_.intrinsics.width, camera_.intrinsics.height});
        if (!writer) return unexpected(writer.error());
        writer_.emplace(std::move(writer).value());
    }
    pixels_too_far_ += static_cast<std::uint64_t>(std::ranges::count_if(
        image->pixels.depth_mm, [](std::uint16_t mm) { return mm > openni2::kDepthMaxMm; }));
    if (auto written = writer_->write(captured, image->pixels.depth_mm); !written) return written;
    ++frames_;
    bytes_ += image->pixels.depth_mm.size() * sizeof(std::uint16_t);
    ++account.used;
    return Done{};
}

Status<Error> BagCamera::close() {
    if (!writer_) return Done{};
    return writer_->close();
}

}  // namespace octoskin::bridge
