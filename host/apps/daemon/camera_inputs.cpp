#include "host/apps/daemon/camera_inputs.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/helper_frames.hpp"
#include "host/core/rig/camera_text.hpp"
#include "hw/rigfile/fed_device.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin {
namespace {

/// Three periods of a slow camera.
std::chrono::milliseconds silence_max(double rate_hz) {
    constexpr std::chrono::milliseconds kUsual{2'000};
    return std::max(kUsual, std::chrono::milliseconds(std::llround(3e3 / rate_hz)));
}

}  // namespace

std::vector<CameraInputs::Wanted> CameraInputs::wanted_of(const std::vector<HostCamera>& cameras) {
    std::vector<Wanted> wanted;
    for (const HostCamera& camera : cameras)
        wanted.push_back({camera.name,
                          camera.device,
                          {camera.intrinsics.width, camera.intrinsics.height, camera.rate_hz}});
    return wanted;
}

void CameraInputs::want(const std::vector<HostCamera>& cameras) {
    std::vector<std::unique_ptr<Camera>> next;
    for (Wanted& wanted : wanted_of(cameras)) {
        const auto same = std::ranges::find_if(
            cameras_, [&wanted](const auto& camera) { return camera && camera->wanted == wanted; });
        next.push_back(same != cameras_.end()
                           ? std::move(*same)
                           : std::make_unique<Camera>(Camera{.wanted = std::move(wanted)}));
    }
    cameras_ = std::move(next);
    attend();
}

void CameraInputs::release_others(const std::vector<HostCamera>& cameras) {
    const std::vector<Wanted> wanted = wanted_of(cameras);
    for (const auto& camera : cameras_)
        if (std::ranges::find(wanted, camera->wanted) == wanted.end()) release(*camera);
}

void CameraInputs::release(Camera& camera) {
    if (!camera.feed) return;
    camera.ready = EventSource();
    camera.fed = nullptr;
    camera.feed->end();
    while (auto frame = camera.feed->take()) {  // at most those that wait
        frame->camera = index_of(camera);
        (void)take_(std::move(*frame));
    }
    leaving_.push_back({camera.wanted.device, std::move(camera.feed)});
}

bool CameraInputs::is_held(const std::string& device) const {
    return std::ranges::any_of(leaving_, [&device](const Leaving& leaving) {
        return device.empty() || leaving.device.empty() || leaving.device == device;
    });
}

void CameraInputs::attend() {
    std::erase_if(leaving_, [](const Leaving& leaving) { return leaving.feed->has_ended(); });
    const HostTime now = monotonic_now();
    for (const auto& camera : cameras_) {
        const bool is_soon = camera->tried && now - *camera->tried < HelperFrames::kRetry;
        if (!camera->feed && !is_soon) open(*camera, now);
    }
}

void CameraInputs::open(Camera& camera, HostTime now) {
    if (!camera.tried && camera.missing.why.empty()) camera.missing.begun = now;
    if (is_held(camera.wanted.device)) {
        camera.missing.why = "it is being released, to be opened in another mode";
        return;
    }
    camera.tried = now;
    try {
        camera.feed =
            std::make_unique<CameraFeed>(source_of(camera), silence_max(camera.wanted.mode.rate_hz));
        camera.ready = loop_.on_readable(camera.feed->descriptor(), [this, &camera] { take_from(camera); });
    } catch (const std::system_error& error) {
        camera.fed = nullptr;
        camera.feed.reset();
        camera.missing.why = std::string("no thread left for it: ") + error.what();
    }
}

/// By the kind of the device.
std::unique_ptr<FrameSource> CameraInputs::source_of(Camera& camera) {
    const Wanted& wanted = camera.wanted;
    const std::chrono::milliseconds silence = silence_max(wanted.mode.rate_hz);
    if (!rig::is_fed_device(wanted.device))
        return std::make_unique<HelperFrames>(wanted.device, silence, std::nullopt, wanted.mode);
    auto fed = std::make_unique<FedFrames>(
        wanted.device, openni2::FrameSize{wanted.mode.width, wanted.mode.height}, silence);
    camera.fed = fed.get();
    return fed;
}

const CameraInputs::Camera* CameraInputs::find(const std::string& name) const {
    const auto found =
        std::ranges::find_if(cameras_, [&name](const auto& camera) { return camera->wanted.name == name; });
    return found == cameras_.end() ? nullptr : found->get();
}

AppError CameraInputs::no_such_camera(const std::string& name) const {
    const Camera* const other = find(name);
    std::vector<std::string> fed;
    for (const auto& camera : cameras_)
        if (rig::is_fed_device(camera->wanted.device))
            fed.push_back(camera->wanted.name.empty() ? "the camera without a name" : camera->wanted.name);
    return {ExitCode::usage,
            {.code = ErrorCode::unknown_name,
             .what = other == nullptr ? "expected the name of a camera of the rig that a program feeds"
                                      : camera_text(name) + " is not fed by a program: its device does not "
                                                            "begin with ros:",
             .value = "'" + (other == nullptr ? name : other->wanted.device) + "'",
             .remedy = fed.empty() ? "a camera is fed if its device is ros:/TOPIC, without --no-camera"
                                   : "there are: " + rig::joined(fed)}};
}

std::optional<AppError> CameraInputs::why_not_fed(const std::string& name) const {
    const Camera* const camera = find(name);
    if (camera == nullptr || !rig::is_fed_device(camera->wanted.device)) return no_such_camera(name);
    if (camera->fed == nullptr)
        return AppError{ExitCode::unavailable,
                        {.code = ErrorCode::no_resources,
                         .what = camera_text(name) + ": " + camera->missing.why,
                         .remedy = "try again in a second"}};
    const std::string feeder = camera->fed->feeder();
    if (feeder.empty()) return std::nullopt;
    return AppError{ExitCode::unavailable,
                    {.code = ErrorCode::in_use,
                     .what = camera_text(name) + " is fed already, by " + feeder,
                     .remedy = "end one of the two programs"}};
}

bool CameraInputs::take_feeder(const std::string& name, int connection) {
    const Camera* const camera = find(name);
    return camera != nullptr && camera->fed != nullptr && camera->fed->take(connection);
}

openni2::FrameSize CameraInputs::size_of(const std::string& name) const {
    const Camera* const camera = find(name);
    assert(camera != nullptr);
    return {camera->wanted.mode.width, camera->wanted.mode.height};
}

std::uint8_t CameraInputs::index_of(const Camera& camera) const {
    const auto found = std::ranges::find(cameras_, &camera, &std::unique_ptr<Camera>::get);
    return static_cast<std::uint8_t>(found - cameras_.begin());
}

void CameraInputs::take_from(Camera& camera) {
    auto frame = camera.feed->take();
    if (!frame) return;
    frame->camera = index_of(camera);
    camera.refused += take_(std::move(*frame)) ? 0U : 1U;
}

std::vector<CameraRecord> CameraInputs::records() const {
    std::vector<CameraRecord> records;
    for (const auto& camera : cameras_) {
        records.push_back(camera->feed ? camera->feed->record() : camera->missing);
        records.back().untimed += camera->refused;
    }
    return records;
}

}  // namespace octoskin
