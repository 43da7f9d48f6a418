#include "host/apps/daemon/recorder.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/version/version.hpp"
#include "host/io/openni2/oni_writer.hpp"

namespace octoskin {
namespace {

RecordingBegin begin_of(const std::filesystem::path& folder, const RecordedSettings& settings,
                        const Pipeline& pipeline, const Recorder::Copier& copier) {
    // Not within the braces below: if the copy throws, GCC 12 destroys a nested aggregate twice.
    orderlog::Header order{.rig_hash = settings.rig_hash,
                           .mapping_crc32 = settings.mapping_crc32(),
                           .form = settings.form,
                           .first_map = std::nullopt};
    return {.paths = RecordingPaths(folder),
            .rig = settings.rig,
            .robot = settings.robot,
            .mapping = settings.mapping,
            .order = std::move(order),
            .placement_crc32 = settings.placement_crc32,
            .first = {copier(pipeline.map()), pipeline.builder().histories(),
                      pipeline.builder().camera_memories()},
            .cameras = settings.cameras};
}

std::vector<double> depths_max_m(const MapBuilder& builder) {
    std::vector<double> depths_m;
    for (std::size_t i = 0; i < builder.cameras(); ++i)
        depths_m.push_back(builder.depth_stage(i).camera().depth_max_m);
    return depths_m;
}

/// Result of `add`; false if there was no memory for it. Its input is already on the map: only the recording
/// lacks it.
template <class Add>
bool has_memory_for(const Add& add) {
    try {
        return add();
    } catch (const std::bad_alloc&) {
        return false;
    }
}

/// How often the system had no memory for an update of this map.
std::uint64_t lacks_of(const FusedMap& map) {
    return map.counters().no_memory + map.counters().ages_without_memory;
}

/// OpenNI2's recorder stores depth up to 32.767 m. For most rigs a larger depth is no value anyway.
bool is_storable(const DepthFrame& frame, double depth_max_m) {
    constexpr double kMmPerM = 1000.0;
    return depth_max_m * kMmPerM <= openni2::kDepthMaxMm ||
           std::ranges::all_of(frame.depth_mm,
                               [](std::uint16_t depth) { return depth <= openni2::kDepthMaxMm; });
}

}  // namespace

Recorder::Recorder(const std::filesystem::path& folder, std::optional<Nanoseconds> limit,
                   const RecordedSettings& settings, Pipeline& pipeline, HostTime now, Copier copier)
    : copier_(std::move(copier)),
      folder_(folder),
      limit_(limit),
      form_(settings.form),
      depths_max_m_(depths_max_m(pipeline.builder())),
      begun_(now),
      pipeline_(&pipeline),
      inputs_at_begin_(pipeline.counter_tables()),
      lacks_(lacks_of(pipeline.map())),
      depth_frames_(pipeline.builder().cameras()),
      writer_(begin_of(folder, settings, pipeline, copier_)) {
    entry_.interface = settings.interface;
    // Poses are still interpolated from earlier samples.
    pipeline.builder().for_each_joint_sample([this](const JointMeasurement& joints) { put(joints); });
    commits_before_ = counts_.commits;
    pipeline.set_listener(this);  // the last step: nothing may throw after it
}

Recorder::~Recorder() {
    if (pipeline_ != nullptr) pipeline_->set_listener(nullptr);
}

void Recorder::on_can(const wire::CanFrame& frame, WallTime stamp) {
    if (stopped_) return;
    entry_.stamp = stamp;
    entry_.frame = frame;
    const bool is_taken = has_memory_for([&] { return writer_.add_can(candump::format_line(entry_)); });
    ++(is_taken ? can_frames_ : counts_.lost_can);
}

void Recorder::put(const Commit& commit) {
    ++counts_.commits;
    const bool is_taken =
        has_memory_for([&] { return writer_.add_order(orderlog::format_commit(commit, form_)); });
    counts_.lost_commits += is_taken ? 0U : 1U;
}

std::uint64_t Recorder::depth_frames() const noexcept {
    return std::accumulate(depth_frames_.begin(), depth_frames_.end(), std::uint64_t{0});
}

void Recorder::lose() noexcept {
    ++counts_.commits;
    ++counts_.lost_commits;
}

bool Recorder::has_map_lacked_memory() noexcept {
    const std::uint64_t lacks = lacks_of(pipeline_->map());
    return lacks != std::exchange(lacks_, lacks);
}

void Recorder::on_reading(const RangeMeasurement& measurement, const Beam&, std::span<const VoxelUpdate>) {
    has_map_lacked_memory() ? lose() : put(measurement);
}

void Recorder::on_wait(const WaitCommit& passed) {
    has_map_lacked_memory() ? lose() : put(passed);
}

void Recorder::on_depth(const DepthFrame& frame, const Evidence&) {
    DepthCommit commit{std::nullopt, frame.captured, frame.camera};
    if (!has_map_lacked_memory() && is_storable(frame, depths_max_m_.at(frame.camera)) &&
        has_memory_for([&] { return writer_.add_depth(frame); })) {
        commit.index = depth_frames_[frame.camera]++;
    } else {
        ++counts_.lost_depth;
    }
    put(commit);
}

void Recorder::on_time_jump() {
    stop(monotonic_now(),
         "the bus time jumped, and a replay could not continue from there: the host that sends SYNC "
         "restarted or was set, another host sends it too, or this machine slept");
}

void Recorder::attend(HostTime now) {
    if (stopped_) return report_end();
    const bool is_long_enough = limit_ && now - begun_ >= *limit_;
    if (is_long_enough || writer_.error()) stop(now);
}

void Recorder::stop(HostTime now, std::string early) {
    if (!stopped_) stop(now, std::move(early), last_map());
}

void Recorder::stop(HostTime now, std::string early, std::optional<FusedMap> last_map) {
    if (stopped_) return;
    stopped_ = now;
    early_ = std::move(early);
    RecordingEnd end{.order = counts_,
                     .remarks = remarks(),
                     .meta = {.made_by = program_version(),
                              .source = "robot",
                              .world = {},
                              .scenario = {},
                              .rig = {},
                              .seed = std::nullopt,
                              .is_depth_noise_free = false,
                              .can_frames = can_frames_,
                              .depth_frames = depth_frames(),
                              .duration_s = seconds_of(now - begun_)},
                     .last_map = std::move(last_map)};
    pipeline_->set_listener(nullptr);
    pipeline_ = nullptr;
    writer_.finish(std::move(end));
    report_end();
}

void Recorder::report_end() {
    const std::string why = error();
    if (is_end_reported_ || (why.empty() && !has_ended())) return;
    is_end_reported_ = true;
    if (!why.empty()) {
        spdlog::error("the recording has failed: {}", why);
    } else if (!early_.empty()) {
        spdlog::warn("recorded only {:.1f} s to {}: {}", seconds_of(*stopped_ - begun_), folder_.string(),
                     early_);
    } else {
        spdlog::info("recorded {:.1f} s to {}", seconds_of(*stopped_ - begun_), folder_.string());
    }
    if (why.empty() && !is_complete())
        spdlog::warn(
            "{} is incomplete, and its replay gives another map: {} commits and {} depth frames are not in "
            "it",
            folder_.string(), counts_.lost_commits, counts_.lost_depth);
}

std::optional<FusedMap> Recorder::last_map() const {
    if (stopped_) return std::nullopt;
    try {
        return copier_(pipeline_->map());
    } catch (const std::bad_alloc&) {
        return std::nullopt;
    }
}

std::string Recorder::remarks() const try {
    std::string text = "# rejected while this was recorded:\n";
    const auto now = pipeline_->counter_tables();
    for (std::size_t unit = 0; unit < now.size(); ++unit) {
        for (std::size_t row = 0; row < now[unit].rejected.size(); ++row) {
            const auto& rejected = now[unit].rejected[row];
            const std::uint64_t count = rejected.count - inputs_at_begin_[unit].rejected[row].count;
            if (count > 0) text += fmt::format("# {} {} {}\n", now[unit].title(), rejected.name, count);
        }
    }
    return text;
} catch (const std::bad_alloc&) {  // they are only for a reader; the recording is complete without them
    return {};
}

nlohmann::ordered_json Recorder::to_json(HostTime now) const {
    const char* state = has_ended() ? "ended" : (stopped_ ? "finishing" : "recording");
    const std::string why = error();
    return {{"state", why.empty() ? state : "failed"},
            {"folder", folder_.string()},
            {"error", why},
            {"seconds", seconds_of(stopped_.value_or(now) - begun_)},
            {"can_frames", can_frames_},
            {"depth_frames", depth_frames()},
            {"commits", counts_.commits - commits_before_},
            {"lost_can", counts_.lost_can},
            {"lost_commits", counts_.lost_commits},
            {"lost_depth", counts_.lost_depth},
            {"is_complete", is_complete()},
            {"ended_early", early_}};
}

}  // namespace octoskin
