#include "host/io/watch/watch_frame.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "host/io/snapshot/bytes.hpp"

namespace octoskin::watch {
namespace {

using snapshot::ByteReader;
using snapshot::ByteWriter;

bool has_flags(FrameKind kind, std::uint8_t flags) {
    const std::uint8_t possible = kind == FrameKind::map ? kBegins | kComplete : 0;
    return (flags & ~possible) == 0;
}

bool is_kind(std::uint8_t kind) {
    switch (static_cast<FrameKind>(kind)) {
        case FrameKind::map:
        case FrameKind::range:
        case FrameKind::joints:
        case FrameKind::status:
        case FrameKind::reload:
        case FrameKind::image:
        case FrameKind::robot:
            return true;
    }
    return false;
}

void put(ByteWriter& writer, const Eigen::Vector3d& vector) {
    for (const double value : vector) writer.put(value);
}

Eigen::Vector3d get_vector(ByteReader& reader) {
    Eigen::Vector3d vector;
    for (double& value : vector) {
        value = reader.get<double>();
        if (!std::isfinite(value)) reader.fail();
    }
    return vector;
}

}  // namespace

void put_header(std::string& bytes, const FrameHeader& header) {
    ByteWriter writer(bytes);
    writer.put(header.bytes);
    writer.put(kVersion);
    writer.put(static_cast<std::uint8_t>(header.kind));
    writer.put(header.flags);
    writer.put(header.number);
    writer.put(header.time.ns);
    writer.put(header.lost);
}

std::optional<FrameHeader> parse_header(std::string_view bytes) {
    ByteReader reader(bytes.substr(0, kHeaderBytes));
    FrameHeader header;
    header.bytes = reader.get<std::uint32_t>();
    const auto version = reader.get<std::uint16_t>();
    const auto kind = reader.get<std::uint8_t>();
    header.flags = reader.get<std::uint8_t>();
    header.number = reader.get<std::uint64_t>();
    header.time.ns = reader.get<std::int64_t>();
    header.lost = reader.get<std::uint64_t>();
    if (!reader.is_sound() || version != kVersion || !is_kind(kind) || header.bytes > kPayloadMax)
        return std::nullopt;
    header.kind = static_cast<FrameKind>(kind);
    return has_flags(header.kind, header.flags) ? std::optional(header) : std::nullopt;
}

std::string range_payload(const WatchedRange& range) {
    std::string bytes;
    ByteWriter writer(bytes);
    writer.put(range.source.node_id);
    writer.put(range.source.sensor);
    writer.put(range.source.zone);
    writer.put_flag(range.range_m.has_value());
    writer.put(range.range_m.value_or(0.0));
    writer.put(range.sigma_m);
    put(writer, range.p_map_sensor);
    put(writer, range.direction_map);
    return bytes;
}

std::string range_payload(const Beam& beam) {
    return range_payload(WatchedRange{.source = beam.source,
                                      .range_m = beam.range_m,
                                      .sigma_m = beam.sigma_m,
                                      .p_map_sensor = beam.p_map_sensor,
                                      .direction_map = beam.direction_map});
}

std::optional<WatchedRange> parse_range(std::string_view payload) {
    ByteReader reader(payload);
    WatchedRange range;
    range.source.node_id = reader.get<std::uint8_t>();
    range.source.sensor = reader.get<std::uint8_t>();
    range.source.zone = reader.get<std::uint8_t>();
    const bool has_target = reader.get_flag();
    const auto range_m = reader.get<double>();
    if (has_target) range.range_m = range_m;
    range.sigma_m = reader.get<double>();
    range.p_map_sensor = get_vector(reader);
    range.direction_map = get_vector(reader);
    const bool is_sound =
        reader.is_sound() && reader.is_over() && std::isfinite(range_m) && std::isfinite(range.sigma_m);
    return is_sound ? std::optional(range) : std::nullopt;
}

std::string joints_payload(const JointMeasurement& joints, std::size_t count) {
    assert(count <= joints.position_rad.size());
    std::string bytes;
    ByteWriter writer(bytes);
    writer.put(joints.source);
    writer.put(static_cast<std::uint8_t>(count));
    for (std::size_t i = 0; i < count; ++i) writer.put(joints.position_rad[i]);
    return bytes;
}

std::optional<WatchedJoints> parse_joints(std::string_view payload) {
    ByteReader reader(payload);
    WatchedJoints joints;
    joints.source = reader.get<std::uint8_t>();
    const auto count = reader.get<std::uint8_t>();
    for (std::size_t i = 0; i < count && reader.is_sound(); ++i) {
        joints.position.push_back(reader.get<double>());
        if (!std::isfinite(joints.position.back())) reader.fail();
    }
    return reader.is_sound() && reader.is_over() ? std::optional(joints) : std::nullopt;
}

std::string reload_payload(std::uint64_t reloads) {
    std::string bytes;
    ByteWriter(bytes).put(reloads);
    return bytes;
}

std::optional<std::uint64_t> parse_reload(std::string_view payload) {
    ByteReader reader(payload);
    const auto reloads = reader.get<std::uint64_t>();
    return reader.is_sound() && reader.is_over() ? std::optional(reloads) : std::nullopt;
}

std::string image_payload(const DepthFrame& frame) {
    const auto step_to = [](std::uint32_t pixels, std::uint32_t max) { return (pixels + max - 1) / max; };
    const std::uint32_t step =
        std::max({1U, step_to(frame.width, kImageWidthMax), step_to(frame.height, kImageHeightMax)});
    const std::uint32_t width = frame.width / step;
    const std::uint32_t height = frame.height / step;
    std::string bytes;
    ByteWriter writer(bytes);
    writer.put(frame.camera);
    writer.put(static_cast<std::uint16_t>(width));
    writer.put(static_cast<std::uint16_t>(height));
    for (std::uint32_t v = 0; v < height; ++v)
        for (std::uint32_t u = 0; u < width; ++u)
            writer.put(frame.depth_mm[std::size_t{v} * step * frame.width + std::size_t{u} * step]);
    return bytes;
}

std::optional<WatchedImage> parse_image(std::string_view payload) {
    ByteReader reader(payload);
    WatchedImage image;
    image.camera = reader.get<std::uint8_t>();
    image.width = reader.get<std::uint16_t>();
    image.height = reader.get<std::uint16_t>();
    if (!reader.is_sound() || image.width > kImageWidthMax || image.height > kImageHeightMax)
        return std::nullopt;
    image.depth_mm.resize(std::size_t{image.width} * image.height);
    for (std::uint16_t& depth : image.depth_mm) depth = reader.get<std::uint16_t>();
    return reader.is_sound() && reader.is_over() ? std::optional(std::move(image)) : std::nullopt;
}

}  // namespace octoskin::watch
