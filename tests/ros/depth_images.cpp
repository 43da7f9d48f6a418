#include "tests/ros/depth_images.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "tests/ros/headers.hpp"
#include "tests/ros/output.hpp"

namespace octoskin::ros {
namespace {

/// The bytes of an image's pixels: the first one counts, all others have one depth.
Bytes pixels(int count, std::size_t size, const std::string& encoding, double depth_m) {
    const bool is_real = encoding == "32FC1";
    const auto element = [is_real](double value) {
        Bytes bytes(is_real ? 4 : 2);
        const auto real = static_cast<float>(value);
        const auto whole = static_cast<std::uint16_t>(static_cast<std::uint32_t>(value) & 0xffff);
        std::memcpy(bytes.data(), is_real ? static_cast<const void*>(&real) : &whole, bytes.size());
        return bytes;
    };
    const Bytes first = element(count);
    const Bytes other = element(is_real ? depth_m : 1000.0 * depth_m);
    Bytes all;
    for (std::size_t i = 0; i < size; ++i) {
        const Bytes& bytes = i == 0 ? first : other;
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
}

struct ImageSize {
    int width = 0;
    int height = 0;
};

ImageSize image_size(const std::string& text) {
    ImageSize size;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2 || size.width < 1 ||
        size.height < 1) {
        throw std::invalid_argument("--images: not WxH: '" + text + "'");
    }
    return size;
}

/// An image whose data is the end of its bytes, as in sensor_msgs/Image.
Bytes image_without_pixels(const Codec& codec, const Headers& headers, const ImageSize& size,
                           const std::string& encoding) {
    const int pixel_size = encoding == "32FC1" ? 4 : 2;
    Json fields = {{"height", size.height},
                   {"width", size.width},
                   {"encoding", encoding},
                   {"step", size.width * pixel_size},
                   {"data", {{"size", size.width * size.height * pixel_size}}}};
    headers.change(fields, codec);
    return codec.encode(fields);
}

}  // namespace

void say_images(const Arguments& arguments, Saying& saying) {
    const Codec& codec = find_codec("sensor_msgs/Image");
    const auto size = image_size(arguments.text("--images", ""));
    const auto encoding = arguments.choice("--encoding", {"16UC1", "32FC1"});
    const auto topic = arguments.text("--topic", "/camera/depth/image_rect_raw");
    const double rate_hz = arguments.number("--rate", 30);
    const double depth_m = arguments.number("--depth-m", 1);
    const Headers headers(arguments);
    const Bytes all = pixels(0, static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height),
                             encoding, depth_m);
    saying.writer_of(topic, codec, qos_of(arguments));
    const auto start = Clock::now();
    const int count = arguments.whole("--count", 100);
    for (int i = 0; i < count && !is_told_to_end(); ++i) {
        sleep_until(after(start, i / rate_hz));
        Bytes bytes = image_without_pixels(codec, headers, size, encoding);
        std::copy(all.begin(), all.end(), bytes.end() - static_cast<std::ptrdiff_t>(all.size()));
        const Bytes first = pixels(i, 1, encoding, depth_m);
        std::copy(first.begin(), first.end(), bytes.end() - static_cast<std::ptrdiff_t>(all.size()));
        saying.say(topic, bytes);
    }
}

}  // namespace octoskin::ros
