// The live depth cameras of a rig. Each is opened, lost and opened again by itself.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/camera_feed.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/fed_frames.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/io/openni2/camera_mode.hpp"

namespace octoskin {

class CameraInputs {
  public:
    /// Takes a frame with its camera's index in the rig. False: its capture time is not known on the bus
    /// clock.
    using Take = std::function<bool(DepthFrame frame)>;

    /// `loop` must outlive it.
    CameraInputs(EventLoop& loop, Take take) : loop_(loop), take_(std::move(take)) {}
    CameraInputs(const CameraInputs&) = delete;
    CameraInputs& operator=(const CameraInputs&) = delete;

    /// Switches to these cameras, in the rig's order. A camera of the same name, device and mode as one
    /// before continues. First call `release_others`.
    void want(const std::vector<HostCamera>& cameras);
    /// Releases each camera that is not among these with the same name, device and mode. Its waiting frames
    /// are taken, with its index so far.
    void release_others(const std::vector<HostCamera>& cameras);
    /// Opens what is not open, once its device is released. If no thread is left, tries again in a second.
    void attend();

    /// Takes over the connection of a program that feeds the camera of this name; empty: the camera without a
    /// name. False: `why_not_fed` has the reason, and the connection stays the caller's.
    [[nodiscard]] bool take_feeder(const std::string& name, int connection);
    /// Why `take_feeder` refuses: no camera of this name is fed, the error names those that are; or it has a
    /// feeder, or is not ready for one. Empty: it does not.
    [[nodiscard]] std::optional<AppError> why_not_fed(const std::string& name) const;
    /// Width and height that the images of this camera must have. It exists (asserted).
    [[nodiscard]] openni2::FrameSize size_of(const std::string& name) const;

    /// In the rig's order; empty: none is wanted. Frames that `Take` refused count as `untimed`.
    [[nodiscard]] std::vector<CameraRecord> records() const;

  private:
    struct Wanted {
        std::string name;
        std::string device;
        openni2::CameraMode mode;
        friend bool operator==(const Wanted&, const Wanted&) = default;
    };
    struct Camera {
        Wanted wanted;
        std::unique_ptr<CameraFeed> feed = {};
        FedFrames* fed = nullptr;  ///< the feed's source, if a program feeds it
        EventSource ready = {};
        CameraRecord missing = {};           ///< the record while no feed exists
        std::optional<HostTime> tried = {};  ///< last attempt to make one
        std::uint64_t refused = 0;           ///< frames that `Take` refused
    };
    struct Leaving {
        std::string device;
        std::unique_ptr<CameraFeed> feed;
    };
    [[nodiscard]] static std::vector<Wanted> wanted_of(const std::vector<HostCamera>& cameras);
    void open(Camera& camera, HostTime now);
    [[nodiscard]] static std::unique_ptr<FrameSource> source_of(Camera& camera);
    [[nodiscard]] const Camera* find(const std::string& name) const;
    [[nodiscard]] AppError no_such_camera(const std::string& name) const;
    [[nodiscard]] bool is_held(const std::string& device) const;
    [[nodiscard]] std::uint8_t index_of(const Camera& camera) const;
    void take_from(Camera& camera);
    void release(Camera& camera);

    EventLoop& loop_;
    Take take_;
    std::vector<std::unique_ptr<Camera>> cameras_;
    std::vector<Leaving> leaving_;  ///< each keeps its device a little longer
};

}  // namespace octoskin
