#include "host/apps/playback/ordered_playback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>

#include "host/apps/playback/pace.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/core/rig/camera_text.hpp"
#include "host/io/mapfile/file_checksum.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/orderlog/order_reader.hpp"
#include "host/io/snapshot/snapshot_file.hpp"

namespace octoskin {
namespace {

/// CRC-32 of the map's .ot file, which is larger than the map: it is never held in memory as a whole.
std::uint32_t crc32_of_map(const FusedMap& map, decltype(write_ot) write) {
    std::uint32_t crc = 0;
    const auto add = [&crc](std::string_view bytes) {
        crc = file_checksum(bytes, crc);
        return true;
    };
    write(map, add);
    return crc;
}

Status<AppError> check_first(const FilePlace& file, std::uint32_t crc) {
    if (!file.is_there()) {
        return fail(ExitCode::no_input, {.code = ErrorCode::not_found,
                                         .what = "does not exist, and this recording began with it",
                                         .remedy = "put it there, or replay with --by-capture-time",
                                         .file = file.shown()});
    }
    if (crc32_of(file) == crc) return Done{};
    return fail(ExitCode::bad_data, {.code = ErrorCode::mismatch,
                                     .what = "is not the file that this recording began with",
                                     .remedy = "put that file there, or replay with --by-capture-time",
                                     .file = file.shown()});
}

Result<LoadedMap, AppError> read_first_map(const PlaybackRequest& request, std::uint32_t crc) {
    const auto file = request.recording.first_map();
    if (const auto checked = check_first(file, crc); !checked) return unexpected(checked.error());
    auto map = load_map_of(request.mapping.map, file);
    if (map) return std::move(map).value();
    const ErrorCode code = map.error().code;
    const bool is_of_other_mapping = code == ErrorCode::mismatch || code == ErrorCode::too_large;
    if (!is_of_other_mapping) return fail(ExitCode::bad_data, map.error());
    return fail(
        ExitCode::bad_config,
        with_remedy(map.error(), "replay with the recording's own mapping, or with --by-capture-time"));
}

Result<MapState, AppError> read_first_state(const PlaybackRequest& request, std::uint32_t crc,
                                            std::uint32_t mapping_crc) {
    const auto file = request.recording.first_state();
    if (const auto checked = check_first(file, crc); !checked) return unexpected(checked.error());
    auto snapshot = load_snapshot(file, request.mapping, mapping_crc);
    if (!snapshot) return fail(ExitCode::bad_data, snapshot.error());
    return std::move(snapshot->state);
}

std::optional<std::uint32_t> placement_of(const rig::Rig& rig) {
    const auto robot = robot_text(rig);
    return robot ? std::optional(rig::placement_crc32(rig, *robot)) : std::nullopt;
}

/// Whether the given rig or robot places measurements elsewhere than the recording's own. Then the daemon's
/// earlier map does not fit.
bool is_placed_otherwise(const PlaybackRequest& request, const rig::Rig& rig) {
    if (request.rig.empty() && request.robot.urdf.empty()) return false;
    const auto own = read_given_rig(request.recording.rig());
    return !own || placement_of(*own) != placement_of(rig);
}

/// Loads the initial state of the recording into `pipeline`. Returns texts for the user.
Result<std::vector<std::string>, AppError> begin_with_first(const PlaybackRequest& request,
                                                            const rig::Rig& rig,
                                                            const orderlog::Header& header,
                                                            bool has_daemons_mapping, Pipeline& pipeline) {
    if ((header.first_state || header.first_map) && is_placed_otherwise(request, rig)) {
        return std::vector<std::string>{
            "the map that the recording began with is left out: the given rig or robot places base, sensors "
            "or camera elsewhere; this map begins empty"};
    }
    if (header.first_state && has_daemons_mapping) {
        auto state = read_first_state(request, *header.first_state, header.mapping_crc32);
        if (!state) return unexpected(state.error());
        std::vector<std::string> warnings;
        const std::string file = request.recording.first_state().shown().string();
        const MapBuilder::LeftOut left_out = pipeline.begin_with(std::move(*state));
        if (left_out.zones > 0)
            warnings.push_back(
                fmt::format("{}: range readings of {} zones are left out: the rig has no such zones", file,
                            left_out.zones));
        for (const std::string& camera : left_out.cameras)
            warnings.push_back(fmt::format("{}: earlier images{} are left out: the rig has no such camera",
                                           file, camera.empty() ? "" : " of " + camera_text(camera)));
        return warnings;
    }
    if (!header.first_map) return std::vector<std::string>{};
    auto first = read_first_map(request, *header.first_map);
    if (!first) return unexpected(first.error());
    pipeline.begin_with(std::move(first->map));
    return std::move(first->warnings);
}

/// Why the map may differ from the daemon's; empty if it must be equal.
std::string why_another(const PlaybackRequest& request, const rig::Rig& rig,
                        const orderlog::OrderReader& order, const OrderedPlayback& played) {
    const OrderedOutcome& outcome = played.outcome;
    if (outcome.order_error || !outcome.depth_errors.empty()) return "the replay did not reach its end";
    if (!order.trailer())
        return "order.log is cut off because the daemon was killed; this is its last complete line";
    if (!order.trailer()->is_complete())
        return fmt::format(
            "the recording is incomplete: {} commits and {} depth frames could not be "
            "recorded as the daemon's map took them (the disk was too slow, there was no "
            "memory, or depth was beyond 32.767 m)",
            order.trailer()->lost_commits, order.trailer()->lost_depth);
    if (order.header().rig_hash != rig::rig_hash(rig) && !request.rig.empty()) return "another rig was given";
    if (!played.has_daemons_mapping && request.is_mapping_given) return "another configuration was given";
    if (outcome.depth_missing > 0)
        return fmt::format("{} depth frames that were recorded are missing", outcome.depth_missing);
    return request.robot.urdf.empty() ? "" : "another robot description was given";
}

/// For a map that must equal the daemon's and does not: the known differences.
std::string guess_at_unlike(const rig::Rig& rig, const orderlog::OrderReader& order,
                            const OrderedPlayback& played) {
    if (order.header().rig_hash != rig::rig_hash(rig)) return "its rig.yaml is not the daemon's";
    if (!played.has_daemons_mapping) return "its mapping.yaml is not the daemon's";
    if (!played.outcome.took_all()) return "input that the daemon used was rejected (see the input counters)";
    return "files of the recording were changed, the processor is of another kind, or octoskin has an "
           "internal error";
}

bool is_daemons(const orderlog::OrderReader& order, const FusedMap& map) {
    if (!order.trailer()) return false;
    const auto& last = order.trailer()->last_map;
    if (!last) return map.known_voxels() == 0;
    // Older versions wrote .ot files without octoskin's comment.
    return crc32_of_map(map, write_ot) == *last || crc32_of_map(map, write_unmarked_ot) == *last;
}

void judge(const PlaybackRequest& request, const rig::Rig& rig, const orderlog::OrderReader& order,
           const FusedMap& map, OrderedPlayback& played) {
    if (is_daemons(order, map)) {
        played.notes.emplace_back("the fused map is identical to the daemon's, byte for byte");
    } else if (const std::string why = why_another(request, rig, order, played); !why.empty()) {
        played.warnings.push_back("the map differs from the daemon's: " + why);
    } else {
        played.is_unlike_daemons = true;
        played.warnings.push_back(
            "the fused map differs from the daemon's, although only the recording was given: " +
            guess_at_unlike(rig, order, played));
    }
}

Unexpected<AppError> of_another_rig(const PlaybackRequest& request, std::string expected, std::string found) {
    return fail(ExitCode::bad_config, {.code = ErrorCode::mismatch,
                                       .what = "expected " + std::move(expected) + ", as in the rig",
                                       .value = std::move(found),
                                       .remedy = "replay with the recording's own rig",
                                       .file = request.recording.order().shown()});
}

Status<AppError> check_form(const PlaybackRequest& request, const rig::Rig& rig,
                            const orderlog::CommitForm& form) {
    const auto joints = rig.joint_counts();
    if (form.joints != joints)
        return of_another_rig(request, orderlog::joints_text(joints) + " joints",
                              orderlog::joints_text(form.joints));
    const std::size_t cameras = std::max(rig.cameras.size(), std::size_t{1});
    if (form.cameras != cameras)
        return of_another_rig(request,
                              fmt::format("the images of {} camera{}", cameras, cameras > 1 ? "s" : ""),
                              fmt::format("{}", form.cameras));
    return Done{};
}

/// The index in the given rig of each camera of the recording's own; empty: the same ones.
using CameraIndices = std::vector<std::uint8_t>;

/// In order.log a camera is its index in the recording's own rig.
Result<CameraIndices, AppError> cameras_by_name(const PlaybackRequest& request, const rig::Rig& rig) {
    if (request.rig.empty() || rig.cameras.size() < 2) return CameraIndices{};
    const auto own = read_given_rig(request.recording.rig());
    if (!own) {
        Error error = own.error().error;
        error.remedy =
            "order.log has the cameras in the order of this rig: mend it, or use --by-capture-time";
        return fail(ExitCode::bad_config, std::move(error));
    }
    CameraIndices indices;
    for (const rig::Camera& camera : own->cameras) {
        const auto found = std::ranges::find(rig.cameras, camera.name, &rig::Camera::name);
        if (found == rig.cameras.end())
            return of_another_rig(request, "images of the same cameras", camera_text(camera.name));
        indices.push_back(static_cast<std::uint8_t>(found - rig.cameras.begin()));
    }
    return indices;
}

/// The commits with the indices of cameras in the given rig.
class CommitsOfRig final : public CommitSource {
  public:
    CommitsOfRig(CommitSource& source, const CameraIndices& cameras) : source_(source), cameras_(cameras) {}
    [[nodiscard]] Result<std::optional<Commit>, Error> next() override {
        auto commit = source_.next();
        if (!commit || !commit->has_value()) return commit;
        auto* const frame = std::get_if<DepthCommit>(&**commit);
        if (frame != nullptr && frame->camera < cameras_.size()) frame->camera = cameras_[frame->camera];
        return commit;
    }

  private:
    CommitSource& source_;
    const CameraIndices& cameras_;
};

}  // namespace

bool is_played_in_order(const PlaybackRequest& request) {
    return !request.is_by_capture_time && request.recording.order().is_there();
}

Result<OrderedPlayback, AppError> play_in_order(const PlaybackRequest& request, const rig::Rig& rig,
                                                Pipeline& pipeline, const DepthSources& depth,
                                                std::optional<HostTime> begin, const ReplayReport& report) {
    auto order = orderlog::OrderReader::open(request.recording.order());
    if (!order) return fail(ExitCode::bad_data, order.error());
    if (const auto checked = check_form(request, rig, order->header().form); !checked)
        return unexpected(checked.error());
    const auto cameras = cameras_by_name(request, rig);
    if (!cameras) return unexpected(cameras.error());
    const bool has_daemons_mapping =
        order->header().mapping_crc32 == file_checksum(mapping_text(request.mapping));
    auto warnings = begin_with_first(request, rig, order->header(), has_daemons_mapping, pipeline);
    if (!warnings) return unexpected(warnings.error());
    if (request.listener != nullptr && pipeline.map().known_voxels() > 0)
        request.listener->on_begin(pipeline.map());
    CommitsOfRig commits(*order, *cameras);
    PacedCommits paced(commits, request.pace, begin);
    OrderedPlayback played{.outcome = replay_in_order(pipeline.builder(), paced, depth, report, begin)};
    played.warnings = std::move(*warnings);
    played.has_daemons_mapping = has_daemons_mapping;
    played.inputs = {tabulate("readings", played.outcome.readings, 0, seconds_text),
                     tabulate("joint samples", played.outcome.joint_samples, 0, seconds_text),
                     tabulate("depth frames", played.outcome.depth_frames, 0, seconds_text)};
    if (const std::uint64_t missing = played.outcome.depth_missing; missing > 0)
        played.warnings.push_back(
            fmt::format("{} depth frames that the daemon used are not in the recording", missing));
    judge(request, rig, *order, pipeline.map(), played);
    return played;
}

}  // namespace octoskin
