// An OpenNI2 driver with one depth camera that a file plugs in: while the file $OCTOSKIN_TEST_CAMERA exists,
// the camera is connected and shows a wall at the distance in the file, millimetres; a second number is for
// the left half. It mirrors the image unless mirroring is switched off, as OpenNI2's drivers do, or always
// with $OCTOSKIN_TEST_CAMERA_MIRRORS. Its frames come at the mode's rate, with time stamps of its own clock.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <thread>

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

namespace {

/// It begins with the first.
constexpr std::array<OniVideoMode, 3> kModes{{
    {.pixelFormat = ONI_PIXEL_FORMAT_DEPTH_1_MM, .resolutionX = 80, .resolutionY = 60, .fps = 2},
    {.pixelFormat = ONI_PIXEL_FORMAT_DEPTH_1_MM, .resolutionX = 160, .resolutionY = 120, .fps = 30},
    {.pixelFormat = ONI_PIXEL_FORMAT_DEPTH_100_UM, .resolutionX = 80, .resolutionY = 60, .fps = 2},
}};
constexpr int kDepthMax = 10'000;

struct Wall {
    OniDepthPixel right_mm;
    OniDepthPixel left_mm;
};
/// The scene of the camera; empty if it is not plugged in.
std::optional<Wall> wall() {
    const char* const name = std::getenv("OCTOSKIN_TEST_CAMERA");
    if (name == nullptr) return std::nullopt;
    std::ifstream file(name);
    unsigned right_mm = 0;
    if (!(file >> right_mm) || right_mm >= kDepthMax) return std::nullopt;
    unsigned left_mm = 0;
    if (!(file >> left_mm) || left_mm >= kDepthMax) left_mm = right_mm;
    return Wall{static_cast<OniDepthPixel>(right_mm), static_cast<OniDepthPixel>(left_mm)};
}

template <class T>
OniStatus give(const T& value, void* data, int* size) {
    if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &value, sizeof(T));
    *size = sizeof(T);
    return ONI_STATUS_OK;
}

class WallStream final : public oni::driver::StreamBase {
  public:
    WallStream() = default;
    ~WallStream() override { stop(); }
    WallStream(const WallStream&) = delete;
    WallStream& operator=(const WallStream&) = delete;

    OniStatus start() override {
        is_running_ = true;
        thread_ = std::thread([this] { show(); });
        return ONI_STATUS_OK;
    }
    void stop() override {
        is_running_ = false;
        if (thread_.joinable()) thread_.join();
    }

    OniStatus getProperty(int property, void* data, int* size) override {
        switch (property) {
            case ONI_STREAM_PROPERTY_VIDEO_MODE:
                return give(mode_, data, size);
            case ONI_STREAM_PROPERTY_MAX_VALUE:
                return give(kDepthMax, data, size);
            case ONI_STREAM_PROPERTY_MIN_VALUE:
                return give(0, data, size);
            case ONI_STREAM_PROPERTY_MIRRORING:
                return give(OniBool{is_mirrored_ ? TRUE : FALSE}, data, size);
            case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
            case ONI_STREAM_PROPERTY_VERTICAL_FOV:
                return give(1.0F, data, size);
            default:
                return ONI_STATUS_NOT_IMPLEMENTED;
        }
    }
    OniStatus setProperty(int property, const void* data, int size) override {
        if (property == ONI_STREAM_PROPERTY_MIRRORING && size == static_cast<int>(sizeof(OniBool))) {
            if (std::getenv("OCTOSKIN_TEST_CAMERA_MIRRORS") != nullptr) return ONI_STATUS_NOT_SUPPORTED;
            is_mirrored_ = *static_cast<const OniBool*>(data) != FALSE;
            return ONI_STATUS_OK;
        }
        if (property != ONI_STREAM_PROPERTY_VIDEO_MODE || size != static_cast<int>(sizeof(mode_)))
            return ONI_STATUS_NOT_IMPLEMENTED;
        std::memcpy(&mode_, data, sizeof(mode_));
        return ONI_STATUS_OK;
    }

  private:
    void show() {
        auto next = std::chrono::steady_clock::now();
        for (int index = 1; is_running_; ++index) {
            if (const auto seen = wall()) raise(index, *seen);
            next += std::chrono::milliseconds(1000 / mode_.fps);
            std::this_thread::sleep_until(next);
        }
    }

    void raise(int index, const Wall& seen) {
        OniFrame* const frame = getServices().acquireFrame();
        if (frame == nullptr) return;
        const auto since_begin = std::chrono::steady_clock::now() - begin_;
        frame->timestamp = static_cast<std::uint64_t>(
            std::chrono::duration_cast<std::chrono::microseconds>(since_begin).count());
        frame->sensorType = ONI_SENSOR_DEPTH;
        frame->frameIndex = index;
        frame->videoMode = mode_;
        frame->width = mode_.resolutionX;
        frame->height = mode_.resolutionY;
        frame->croppingEnabled = FALSE;
        frame->cropOriginX = frame->cropOriginY = 0;
        frame->stride = mode_.resolutionX * static_cast<int>(sizeof(OniDepthPixel));
        frame->dataSize = frame->stride * mode_.resolutionY;
        auto* const pixels = static_cast<OniDepthPixel*>(frame->data);
        const int half = mode_.resolutionX / 2;
        for (int row = 0; row < mode_.resolutionY; ++row) {
            auto* const first = pixels + static_cast<std::ptrdiff_t>(row) * mode_.resolutionX;
            std::fill_n(first, half, is_mirrored_ ? seen.right_mm : seen.left_mm);
            std::fill_n(first + half, half, is_mirrored_ ? seen.left_mm : seen.right_mm);
        }
        // Noise: images that are equal bit for bit, or that repeat in turn, are taken for those of a camera
        // that hangs.
        OniDepthPixel* const last = pixels + mode_.resolutionX * mode_.resolutionY - 1;
        for (int bit = 0; bit < 16; ++bit) {
            if (last[-bit] > 0) last[-bit] = static_cast<OniDepthPixel>(last[-bit] + ((index >> bit) & 1));
        }
        raiseNewFrame(frame);
        getServices().releaseFrame(frame);
    }

    OniVideoMode mode_ = kModes.front();  ///< set before it starts
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    std::atomic<bool> is_running_ = false;
    std::atomic<bool> is_mirrored_ = true;
    std::thread thread_;
};

class WallCamera final : public oni::driver::DeviceBase {
  public:
    OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
        *sensors = &sensor_;
        *count = 1;
        return ONI_STATUS_OK;
    }
    oni::driver::StreamBase* createStream(OniSensorType type) override {
        return type == ONI_SENSOR_DEPTH ? new WallStream : nullptr;
    }
    void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  private:
    std::array<OniVideoMode, 3> modes_ = kModes;
    OniSensorInfo sensor_{.sensorType = ONI_SENSOR_DEPTH,
                          .numSupportedVideoModes = static_cast<int>(modes_.size()),
                          .pSupportedVideoModes = modes_.data()};
};

/// Reports the camera to OpenNI2 as a USB driver does: when it is connected and when it is disconnected.
class PluggedDriver final : public oni::driver::DriverBase {
  public:
    explicit PluggedDriver(OniDriverServices* services) : DriverBase(services) {
        std::snprintf(info_.uri, sizeof(info_.uri), "test-camera");
        std::snprintf(info_.vendor, sizeof(info_.vendor), "octoskin");
        std::snprintf(info_.name, sizeof(info_.name), "wall");
    }

    OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                         oni::driver::DeviceDisconnectedCallback disconnected,
                         oni::driver::DeviceStateChangedCallback state_changed, void* cookie) override {
        const OniStatus status = DriverBase::initialize(connected, disconnected, state_changed, cookie);
        look();
        is_running_ = true;
        thread_ = std::thread([this] {
            while (is_running_) {
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
                look();
            }
        });
        return status;
    }
    oni::driver::DeviceBase* deviceOpen(const char* /*uri*/, const char* /*mode*/) override {
        return new WallCamera;
    }
    void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
    void shutdown() override {
        is_running_ = false;
        if (thread_.joinable()) thread_.join();
    }

  private:
    void look() {
        const bool is_plugged = wall().has_value();
        if (is_plugged == was_plugged_) return;
        was_plugged_ = is_plugged;
        is_plugged ? deviceConnected(&info_) : deviceDisconnected(&info_);
    }

    OniDeviceInfo info_{};
    bool was_plugged_ = false;
    std::atomic<bool> is_running_ = false;
    std::thread thread_;
};

}  // namespace

ONI_EXPORT_DRIVER(PluggedDriver)
