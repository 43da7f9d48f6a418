// An OpenNI2 driver with one depth camera that shows given frames. OpenNI2's own recorder can thus write .oni
// files without a camera.
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

#include "host/io/openni2/helpers/virtual_stream.hpp"

namespace {

using octoskin::openni2::kDepthMaxValue;
using octoskin::openni2::kPropertyPushFrame;
using octoskin::openni2::kVirtualUriPrefix;
using octoskin::openni2::VirtualFrame;

std::optional<OniVideoMode> parse_uri(std::string_view uri) {
    const std::string_view prefix = kVirtualUriPrefix;
    if (!uri.starts_with(prefix)) return std::nullopt;
    OniVideoMode mode{
        .pixelFormat = ONI_PIXEL_FORMAT_DEPTH_1_MM, .resolutionX = 0, .resolutionY = 0, .fps = 0};
    const char* at = uri.data() + prefix.size();
    const char* const end = uri.data() + uri.size();
    const auto number = [&](int& value, char separator) {
        const auto [next, error] = std::from_chars(at, end, value);
        const bool is_separated = separator == '\0' ? next == end : next != end && *next == separator;
        at = next == end ? next : next + 1;
        return error == std::errc{} && is_separated && value > 0;
    };
    if (!number(mode.resolutionX, 'x') || !number(mode.resolutionY, '@') || !number(mode.fps, '\0'))
        return std::nullopt;
    return mode;
}

template <class T>
OniStatus give(const T& value, void* data, int* size) {
    if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &value, sizeof(T));
    *size = sizeof(T);
    return ONI_STATUS_OK;
}

class VirtualStream final : public oni::driver::StreamBase {
  public:
    explicit VirtualStream(const OniVideoMode& mode) : mode_(mode) {}

    OniStatus start() override {
        is_started_ = true;
        return ONI_STATUS_OK;
    }
    void stop() override { is_started_ = false; }

    OniBool isPropertySupported(int property) override {
        switch (property) {
            case ONI_STREAM_PROPERTY_VIDEO_MODE:
            case ONI_STREAM_PROPERTY_CROPPING:
            case ONI_STREAM_PROPERTY_STRIDE:
            case ONI_STREAM_PROPERTY_MIRRORING:
            case ONI_STREAM_PROPERTY_MAX_VALUE:
            case ONI_STREAM_PROPERTY_MIN_VALUE:
            case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
            case ONI_STREAM_PROPERTY_VERTICAL_FOV:
                return TRUE;
            default:
                return FALSE;
        }
    }

    OniStatus getProperty(int property, void* data, int* size) override {
        switch (property) {
            case ONI_STREAM_PROPERTY_VIDEO_MODE:
                return give(mode_, data, size);
            // Without CROPPING and STRIDE a recording plays back no frames.
            case ONI_STREAM_PROPERTY_CROPPING:
                return give(OniCropping{}, data, size);
            case ONI_STREAM_PROPERTY_STRIDE:
                return give(stride(), data, size);
            case ONI_STREAM_PROPERTY_MIRRORING:
                return give(OniBool{FALSE}, data, size);
            case ONI_STREAM_PROPERTY_MAX_VALUE:
                return give(int{kDepthMaxValue}, data, size);
            case ONI_STREAM_PROPERTY_MIN_VALUE:
                return give(int{0}, data, size);
            // The true intrinsics are in the rig; OpenNI2 only requires a number.
            case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
                return give(1.2F, data, size);
            case ONI_STREAM_PROPERTY_VERTICAL_FOV:
                return give(1.0F, data, size);
            default:
                return ONI_STATUS_NOT_IMPLEMENTED;
        }
    }

    OniStatus setProperty(int property, const void* data, int size) override {
        if (property == kPropertyPushFrame && size == static_cast<int>(sizeof(VirtualFrame))) {
            return push(*static_cast<const VirtualFrame*>(data));
        }
        // The URI sets the mode; applications set the same mode again at their start.
        if (property == ONI_STREAM_PROPERTY_VIDEO_MODE || property == ONI_STREAM_PROPERTY_MIRRORING)
            return ONI_STATUS_OK;
        return ONI_STATUS_NOT_IMPLEMENTED;
    }

    void notifyAllProperties() override {
        const int max_value = kDepthMaxValue;
        const int min_value = 0;
        const int stride_bytes = stride();
        const OniCropping cropping{};
        const OniBool mirroring = FALSE;
        raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &mode_, sizeof(mode_));
        raisePropertyChanged(ONI_STREAM_PROPERTY_CROPPING, &cropping, sizeof(cropping));
        raisePropertyChanged(ONI_STREAM_PROPERTY_STRIDE, &stride_bytes, sizeof(stride_bytes));
        raisePropertyChanged(ONI_STREAM_PROPERTY_MIRRORING, &mirroring, sizeof(mirroring));
        raisePropertyChanged(ONI_STREAM_PROPERTY_MAX_VALUE, &max_value, sizeof(max_value));
        raisePropertyChanged(ONI_STREAM_PROPERTY_MIN_VALUE, &min_value, sizeof(min_value));
    }

  private:
    [[nodiscard]] int stride() const { return mode_.resolutionX * static_cast<int>(sizeof(OniDepthPixel)); }

    OniStatus push(const VirtualFrame& given) {
        if (!is_started_) return ONI_STATUS_OUT_OF_FLOW;
        OniFrame* frame = getServices().acquireFrame();
        if (frame == nullptr) return ONI_STATUS_ERROR;
        frame->sensorType = ONI_SENSOR_DEPTH;
        frame->timestamp = given.timestamp_us;
        frame->frameIndex = given.index;
        frame->width = mode_.resolutionX;
        frame->height = mode_.resolutionY;
        frame->videoMode = mode_;
        frame->croppingEnabled = FALSE;
        frame->cropOriginX = 0;
        frame->cropOriginY = 0;
        frame->stride = stride();
        frame->dataSize = stride() * mode_.resolutionY;
        std::memcpy(frame->data, given.pixels, static_cast<std::size_t>(frame->dataSize));
        raiseNewFrame(frame);
        getServices().releaseFrame(frame);
        return ONI_STATUS_OK;
    }

    OniVideoMode mode_;
    bool is_started_ = false;
};

class VirtualDevice final : public oni::driver::DeviceBase {
  public:
    explicit VirtualDevice(const OniVideoMode& mode) : mode_(mode) {
        sensor_.sensorType = ONI_SENSOR_DEPTH;
        sensor_.numSupportedVideoModes = 1;
        sensor_.pSupportedVideoModes = &mode_;
    }
    OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
        *sensors = &sensor_;
        *count = 1;
        return ONI_STATUS_OK;
    }
    oni::driver::StreamBase* createStream(OniSensorType type) override {
        return type == ONI_SENSOR_DEPTH ? new VirtualStream(mode_) : nullptr;
    }
    void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  private:
    OniVideoMode mode_;
    OniSensorInfo sensor_{};
};

class VirtualDriver final : public oni::driver::DriverBase {
  public:
    explicit VirtualDriver(OniDriverServices* services) : DriverBase(services) {}

    OniStatus tryDevice(const char* uri) override {
        if (!parse_uri(uri)) return ONI_STATUS_ERROR;
        OniDeviceInfo info{};
        std::snprintf(info.uri, sizeof(info.uri), "%s", uri);
        std::snprintf(info.vendor, sizeof(info.vendor), "octoskin");
        std::snprintf(info.name, sizeof(info.name), "virtual depth camera");
        deviceConnected(&info);
        return ONI_STATUS_OK;
    }
    oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
        const auto mode = parse_uri(uri);
        return mode ? new VirtualDevice(*mode) : nullptr;
    }
    void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
    void shutdown() override {}
};

}  // namespace

ONI_EXPORT_DRIVER(VirtualDriver)
