#include "host/io/snapshot/camera_records.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "host/core/rig/host_rig.hpp"
#include "host/io/snapshot/matrices.hpp"

namespace octoskin::snapshot {
namespace {

constexpr float kMeanMax_m = 100.0F;
constexpr std::uint32_t kSideMax = 4096;
static_assert(std::uint64_t{kSideMax} * kSideMax == kCameraPixelsMax);
constexpr std::uint64_t kHasEnd = 1;
constexpr std::uint64_t kIsHeld = 2;
constexpr unsigned kCountShift = 2;

bool has_value(const CameraMemory::Pixel& pixel) {
    return pixel.depth.count != 0.0F;
}

bool is_empty(const CameraMemory::Pixel& pixel) {
    return pixel == CameraMemory::Pixel{};
}

void put_end(ByteWriter& writer, const EndMemory::End& end) {
    writer.put(static_cast<std::uint16_t>(end.key_xy));
    writer.put(static_cast<std::uint16_t>(end.key_xy >> 16U));
    writer.put(static_cast<std::uint16_t>(end.key_z));
    writer.put(end.depth_m);
}

EndMemory::End get_end(ByteReader& reader) {
    EndMemory::End end;
    end.key_xy = reader.get<std::uint16_t>();
    end.key_xy |= std::uint32_t{reader.get<std::uint16_t>()} << 16U;
    end.key_z = reader.get<std::uint16_t>();
    end.depth_m = reader.get<float>();
    if (!std::isfinite(end.depth_m) || !(end.depth_m > 0.0F)) reader.fail();
    return end;
}

void put_pixel(ByteWriter& writer, const CameraMemory::Pixel& pixel) {
    const bool has_end = pixel.end.key_z != ProjectedImage::kNoKey;
    const auto count = static_cast<std::uint64_t>(std::fabs(pixel.depth.count));
    writer.put(pixel.depth.mean_m);
    writer.put(pixel.depth.drift);
    writer.put_count(count << kCountShift | (pixel.depth.count < 0.0F ? kIsHeld : 0) |
                     (has_end ? kHasEnd : 0));
    if (has_end) put_end(writer, pixel.end);
}

void put_row(ByteWriter& writer, std::span<const CameraMemory::Pixel> row) {
    for (auto next = row.begin(); next != row.end();) {
        const auto first = std::find_if(next, row.end(), has_value);
        assert(std::all_of(next, first, is_empty));
        writer.put_count(static_cast<std::uint64_t>(first - next));
        if (first == row.end()) return;
        next = std::find_if_not(first, row.end(), has_value);
        writer.put_count(static_cast<std::uint64_t>(next - first));
        std::for_each(first, next, [&](const CameraMemory::Pixel& pixel) { put_pixel(writer, pixel); });
    }
}

void put_name(ByteWriter& writer, const std::string& name) {
    writer.put_count(name.size());
    for (const char letter : name) writer.put(static_cast<std::uint8_t>(letter));
}

std::string get_name(ByteReader& reader) {
    const std::uint64_t length = reader.get_count();
    if (length > kCameraNameMax) reader.fail();
    std::string name;
    for (std::uint64_t i = 0; i < length && reader.is_sound(); ++i)
        name += static_cast<char>(reader.get<std::uint8_t>());
    return name;
}

/// False for a NaN.
bool is_pose(const Eigen::Isometry3d& T_map_camera) {
    constexpr double kNotTurned = 1e-6;
    const Eigen::Matrix3d turned_back = T_map_camera.linear().transpose() * T_map_camera.linear();
    return T_map_camera.translation().allFinite() &&
           (turned_back - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kNotTurned;
}

}  // namespace

void put_camera(BlockWriter& blocks, const CameraMemory& memory) {
    blocks.add(BlockKind::camera, [&](ByteWriter& writer, bool) {
        put_name(writer, memory.name);
        writer.put(memory.width);
        writer.put(memory.height);
        put_matrix(writer, Eigen::Matrix3d(memory.T_map_camera.linear()));
        put_matrix(writer, Eigen::Vector3d(memory.T_map_camera.translation()));
    });
    for (std::size_t v = 0; v < memory.height; ++v)
        blocks.add(BlockKind::camera, [&](ByteWriter& writer, bool) {
            put_row(writer, std::span(memory.pixels).subspan(v * memory.width, memory.width));
        });
}

BlockRead CameraTaker::take(std::string_view payload) {
    ByteReader reader(payload);
    while (!reader.is_over()) {
        if (is_complete()) {
            if (const BlockRead taken = take_head(reader); taken != BlockRead::all) return taken;
        } else if (!take_row(reader)) {
            return BlockRead::malformed;
        }
    }
    return reader.is_sound() ? BlockRead::all : BlockRead::malformed;
}

/// A row without any value takes two bytes of the file: the file's size is no limit.
bool CameraTaker::is_within_limit() const noexcept {
    std::uint64_t pixels = 0;
    for (const CameraMemory& memory : memories_) pixels += std::uint64_t{memory.width} * memory.height;
    return pixels * sizeof(CameraMemory::Pixel) <= std::uint64_t{mapping_.map.memory_max_mib} << 20U;
}

bool CameraTaker::is_complete() const noexcept {
    if (memories_.empty()) return true;
    const CameraMemory& memory = memories_.back();
    return memory.pixels.size() == std::size_t{memory.width} * memory.height;
}

BlockRead CameraTaker::take_head(ByteReader& reader) {
    CameraMemory memory;
    memory.name = get_name(reader);
    memory.width = reader.get<std::uint32_t>();
    memory.height = reader.get<std::uint32_t>();
    Eigen::Matrix3d R_map_camera;
    Eigen::Vector3d p_map_camera;
    get_matrix(reader, R_map_camera);
    get_matrix(reader, p_map_camera);
    memory.T_map_camera.linear() = R_map_camera;
    memory.T_map_camera.translation() = p_map_camera;
    const auto is_side = [](std::uint32_t side) { return side >= 1 && side <= kSideMax; };
    const bool is_possible = reader.is_sound() && mapping_.depth_update == DepthUpdate::denoised &&
                             is_side(memory.width) && is_side(memory.height) &&
                             is_pose(memory.T_map_camera) && is_new(memory);
    if (!is_possible) return BlockRead::malformed;
    memories_.push_back(std::move(memory));
    return is_within_limit() ? BlockRead::all : BlockRead::no_room;
}

bool CameraTaker::is_new(const CameraMemory& memory) const noexcept {
    return memories_.size() < kCamerasMax &&
           std::ranges::find(memories_, memory.name, &CameraMemory::name) == memories_.end();
}

bool CameraTaker::take_row(ByteReader& reader) {
    auto& pixels = memories_.back().pixels;
    const std::size_t end = pixels.size() + memories_.back().width;
    while (pixels.size() < end) {
        const std::uint64_t without = reader.get_count();
        if (!reader.is_sound() || without > end - pixels.size()) return false;
        pixels.resize(pixels.size() + without);
        if (pixels.size() == end) return true;
        const std::uint64_t with = reader.get_count();
        if (!reader.is_sound() || with == 0 || with > end - pixels.size()) return false;
        for (std::uint64_t i = 0; i < with && reader.is_sound(); ++i) pixels.push_back(take_pixel(reader));
        if (!reader.is_sound()) return false;
    }
    return true;
}

CameraMemory::Pixel CameraTaker::take_pixel(ByteReader& reader) const {
    CameraMemory::Pixel pixel;
    pixel.depth.mean_m = reader.get<float>();
    pixel.depth.drift = reader.get<float>();
    const std::uint64_t count = reader.get_count();
    const auto values = static_cast<float>(count >> kCountShift);
    pixel.depth.count = (count & kIsHeld) != 0 ? -values : values;
    if ((count & kHasEnd) != 0) pixel.end = get_end(reader);
    if (!is_possible(pixel.depth)) reader.fail();
    return pixel;
}

bool CameraTaker::is_possible(const DepthDenoiser::Pixel& depth) const noexcept {
    const DepthDenoiserConfig& limits = mapping_.depth_denoiser;
    const float count = std::fabs(depth.count);
    return depth.mean_m > 0.0F && depth.mean_m <= kMeanMax_m && count >= 1.0F &&
           count <= static_cast<float>(limits.count_max) &&
           std::fabs(depth.drift) <= static_cast<float>(limits.drift_sigmas);
}

}  // namespace octoskin::snapshot
