#include "host/io/openni2/helpers/camera_list.hpp"

#include <OpenNI.h>

#include <string>

namespace octoskin::openni2 {
namespace {

bool is_same(const openni::VideoMode& a, const openni::VideoMode& b) {
    return a.getResolutionX() == b.getResolutionX() && a.getResolutionY() == b.getResolutionY() &&
           a.getFps() == b.getFps() && a.getPixelFormat() == b.getPixelFormat();
}

std::string mode_line(const openni::VideoMode& mode, bool is_first) {
    std::string line = "  " + std::to_string(mode.getResolutionX()) + " x " +
                       std::to_string(mode.getResolutionY()) + " at " + std::to_string(mode.getFps()) + " Hz";
    if (mode.getPixelFormat() != openni::PIXEL_FORMAT_DEPTH_1_MM)
        line += ", not in millimetres: octoskin cannot read it";
    return line + (is_first ? "  <- initial mode\n" : "\n");
}

/// The first line of OpenNI2's error text.
std::string own_words() {
    const std::string words = openni::OpenNI::getExtendedError();
    return words.substr(0, words.find('\n'));
}

std::string modes_of(const char* uri) {
    openni::Device device;
    if (device.open(uri) != openni::STATUS_OK)
        return "  cannot be opened: " + own_words() + " (does a running octoskin use it, may you use it?)\n";
    const openni::SensorInfo* const sensor = device.getSensorInfo(openni::SENSOR_DEPTH);
    openni::VideoStream stream;
    if (sensor == nullptr || stream.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK)
        return "  gives no depth\n";
    const openni::VideoMode first = stream.getVideoMode();
    const auto& modes = sensor->getSupportedVideoModes();
    std::string lines;
    for (int i = 0; i < modes.getSize(); ++i) lines += mode_line(modes[i], is_same(modes[i], first));
    return lines;
}

}  // namespace

std::string camera_list() {
    openni::Array<openni::DeviceInfo> devices;
    openni::OpenNI::enumerateDevices(&devices);
    std::string text;
    for (int i = 0; i < devices.getSize(); ++i) {
        const openni::DeviceInfo& device = devices[i];
        text += std::string(device.getUri()) + "\n  " + device.getVendor() + ", " + device.getName() + "\n";
        text += modes_of(device.getUri());
    }
    return text;
}

}  // namespace octoskin::openni2
