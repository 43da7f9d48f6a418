// One camera of the rig whose images come from a topic: subscribes, checks, converts and forwards them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/bridge/bridge/frame_sender.hpp"
#include "host/bridge/bridge/inlet.hpp"
#include "host/bridge/received/recent.hpp"
#include "host/bridge/received/stamp.hpp"
#include "host/bridge/robot/robot_facts.hpp"

namespace octoskin::bridge {

/// Each image is counted under exactly one of them, but for `lost`, which never arrived.
struct ImageCounts {
    std::uint64_t received = 0;
    std::uint64_t forwarded = 0;
    std::uint64_t malformed = 0;       ///< not the encoding of an image's message
    std::uint64_t encoding = 0;        ///< ImageFault
    std::uint64_t wrong_size = 0;      ///< ImageFault
    std::uint64_t short_data = 0;      ///< ImageFault
    std::uint64_t no_camera_info = 0;  ///< the camera's description has not come, or is not the rig's camera
    std::uint64_t ahead = 0;           ///< the stamp is ahead of this machine's clock
    std::uint64_t behind = 0;          ///< the stamp is too old
    std::uint64_t still = 0;           ///< the stamp is not newer than the one before
    std::uint64_t second_sender = 0;   ///< another publisher of the topic is at work
    std::uint64_t lost = 0;            ///< on the way, or replaced by newer ones before they were taken
};

class ImageInlet {
  public:
    /// `camera` has a topic (asserted). Throws std::system_error if there is no thread left.
    ImageInlet(const dds::Participant& participant, CameraFacts camera, std::filesystem::path control);

    void attend(const std::vector<dds::Endpoint>& writers, HostTime now);
    /// Takes what has arrived. Throws std::bad_alloc.
    void take(const std::function<Arrival(const dds::Sample&)>& arrival_of);

    /// Call it about twice a second, for `problems`.
    void note_counts(HostTime now) { lately_.note(counts(), now); }

    [[nodiscard]] const CameraFacts& camera() const noexcept { return camera_; }
    [[nodiscard]] std::string topic() const { return images_.topic(); }
    [[nodiscard]] ImageCounts counts() const;
    [[nodiscard]] std::size_t publishers() const noexcept { return images_.publishers(); }
    [[nodiscard]] FrameSenderRecord sender() const { return sender_.record(); }
    /// What a user has to change, in sentences.
    [[nodiscard]] std::vector<std::string> problems(HostTime now) const;

  private:
    void take_image(const dds::Sample& sample, const Arrival& arrival);
    void take_info(const dds::Sample& sample);
    void count(ImageFault fault);
    [[nodiscard]] bool has_rival(std::uint64_t publisher, HostTime now);

    CameraFacts camera_;
    Inlet images_;
    Inlet info_;
    FrameSender sender_;
    ImageCounts counts_;
    bool is_info_right_ = false;
    std::string info_problem_;
    std::string other_encoding_;
    WallTime newest_stamp_;
    std::map<std::uint64_t, HostTime> publishers_at_;  ///< when each sent its newest image
    Nanoseconds stamp_age_{0};
    Recent<ImageCounts> lately_;
    std::optional<HostTime> begun_;
};

}  // namespace octoskin::bridge
