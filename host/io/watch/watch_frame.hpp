// A frame of `watch`: a header of 32 bytes and a payload, little-endian.
//
//     bytes of the payload (32 bits), version (16), kind (8), flags (8)
//     number of this watcher's frames before (64)
//     time (64): bus time in nanoseconds, of the map, the capture, the sample; 0: not known
//     lost (64): frames so far that this watcher did not get, because it read too slowly
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/can_intake.hpp"

namespace octoskin::watch {

inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::size_t kHeaderBytes = 32;
/// Limit of a payload. Bricks go out in payloads of at most kMapBytes and one brick more.
inline constexpr std::size_t kPayloadMax = std::size_t{4} << 20U;

enum class FrameKind : std::uint8_t {
    map = 1,     ///< bricks (map_changes.hpp)
    range = 2,   ///< a reading that is in the map
    joints = 3,  ///< a sample of one source of joint states
    status = 4,  ///< the status as JSON, as `status` answers it
    reload = 5,  ///< what follows is of the rig that `describe` answers with this number of reloads
    image = 6,   ///< a reduced depth image that is in the map
    robot = 7,   ///< the robot's URDF as text
};

/// True for a kind of which the newest frame reaches a watcher, however slowly it reads.
[[nodiscard]] constexpr bool is_lasting(FrameKind kind) noexcept {
    return kind == FrameKind::reload || kind == FrameKind::robot;
}

/// A frame of a map: nothing that was sent before holds; an empty map begins.
inline constexpr std::uint8_t kBegins = 1;
/// A frame of a map: with this one, the reader has the whole map of that time.
inline constexpr std::uint8_t kComplete = 2;

struct FrameHeader {
    std::uint32_t bytes = 0;
    FrameKind kind = FrameKind::map;
    std::uint8_t flags = 0;
    std::uint64_t number = 0;
    HostTime time{0};
    std::uint64_t lost = 0;
    friend bool operator==(const FrameHeader&, const FrameHeader&) = default;
};

/// Appends the header. Throws std::bad_alloc.
void put_header(std::string& bytes, const FrameHeader& header);
/// From the first kHeaderBytes. Empty: another version, a kind or flags that do not exist, or a payload of
/// more than kPayloadMax. Safe for any bytes.
[[nodiscard]] std::optional<FrameHeader> parse_header(std::string_view bytes);

/// A reading with the place of its beam, map frame, metres.
struct WatchedRange {
    BeamSource source;
    std::optional<double> range_m;  ///< empty: no target
    double sigma_m = 0.0;
    Eigen::Vector3d p_map_sensor = Eigen::Vector3d::Zero();
    Eigen::Vector3d direction_map = Eigen::Vector3d::UnitZ();
};
[[nodiscard]] std::string range_payload(const WatchedRange& range);
[[nodiscard]] std::string range_payload(const Beam& beam);
[[nodiscard]] std::optional<WatchedRange> parse_range(std::string_view payload);

/// A sample of a source of the rig (`joint_states.sources` of the status has its joints), radians or metres.
struct WatchedJoints {
    std::uint8_t source = 0;
    std::vector<double> position;
};
/// `count`: joints of the source.
[[nodiscard]] std::string joints_payload(const JointMeasurement& joints, std::size_t count);
[[nodiscard]] std::optional<WatchedJoints> parse_joints(std::string_view payload);

/// `reloads`: how often the daemon has taken another rig since its start (`reloads` of `describe`).
[[nodiscard]] std::string reload_payload(std::uint64_t reloads);
[[nodiscard]] std::optional<std::uint64_t> parse_reload(std::string_view payload);

/// A depth image with every n-th pixel of every n-th row.
struct WatchedImage {
    std::uint8_t camera = 0;  ///< index in the rig's list
    std::uint16_t width = 0;
    std::uint16_t height = 0;
    std::vector<std::uint16_t> depth_mm;  ///< row-major; 0: no value
};
inline constexpr std::uint32_t kImageWidthMax = 160;
inline constexpr std::uint32_t kImageHeightMax = 120;
/// The smallest n by which the image fits into kImageWidthMax x kImageHeightMax. O(pixels left).
[[nodiscard]] std::string image_payload(const DepthFrame& frame);
[[nodiscard]] std::optional<WatchedImage> parse_image(std::string_view payload);

}  // namespace octoskin::watch
