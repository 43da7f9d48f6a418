// The depth images of one camera of a bag, into the depth recording of that camera.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/bridge/mcap/bag_account.hpp"
#include "host/bridge/recorded/bus_clock.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/io/mcap/mcap_reader.hpp"
#include "host/io/openni2/oni_writer.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

class BagCamera {
  public:
    /// `info`: the camera as the bag describes it; null: the bag does not, and its images are not used.
    BagCamera(CameraFacts camera, std::string topic, const ros::sensor_msgs::CameraInfo* info);

    [[nodiscard]] const std::string& topic() const noexcept { return topic_; }
    /// Takes an image; counts it in `account`. `stamp`: the time of its content. Error: the depth recording
    /// cannot be written.
    [[nodiscard]] Status<Error> take(const mcap::Message& message, const RecordingPaths& paths,
                                     const BusClock& clock, bool uses_log_time, TopicAccount& account);
    [[nodiscard]] Status<Error> close();

    [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }
    /// Of all frames that were written, before the recorder compresses them.
    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
    /// Why no image is used, as a sentence; empty if they can be.
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
    /// Pixels beyond 32.767 m, which a recording cannot hold.
    [[nodiscard]] std::uint64_t pixels_too_far() const noexcept { return pixels_too_far_; }

  private:
    CameraFacts camera_;
    std::string topic_;
    std::string problem_;
    std::optional<openni2::OniWriter> writer_;
    std::optional<HostTime> newest_;
    std::uint64_t frames_ = 0;
    std::uint64_t bytes_ = 0;
    std::uint64_t pixels_too_far_ = 0;
};

}  // namespace octoskin::bridge
