// `octoskin record`: what the daemon takes in and what it puts into its map, kept from one moment to another.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "common/wire/crc.hpp"
#include "host/apps/daemon/recording_writer.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/io/candump/log_line.hpp"

namespace octoskin {

/// What the daemon runs with, as text: so that a recording holds what was in force, not what the files say by
/// then.
struct RecordedSettings {
    std::string rig;
    std::string robot;
    std::string mapping;
    std::uint32_t rig_hash = 0;
    std::uint32_t placement_crc32 = 0;  ///< rig::placement_crc32
    std::size_t joints = 0;
    std::string interface;
    /// Of the mapping's text.
    [[nodiscard]] std::uint32_t mapping_crc32() const noexcept {
        return crc32({reinterpret_cast<const std::uint8_t*>(mapping.data()), mapping.size()});
    }
    friend bool operator==(const RecordedSettings&, const RecordedSettings&) = default;
};

class Recorder final : public CommitListener {
  public:
    using Copier = std::function<FusedMap(const FusedMap& map)>;

    /// Begins with the pipeline as it is, at any time, and changes nothing of it but its listener: the map
    /// goes on as if nothing was recorded. `pipeline` must outlive the recording: until `stop`. Waits for
    /// nothing: what is wrong with the folder shows in `error`. Throws std::bad_alloc if there is no memory
    /// for a copy of the map, std::system_error if there is no thread to be had; the pipeline then knows
    /// nothing of it.
    Recorder(const std::filesystem::path& folder, std::optional<Nanoseconds> limit,
             const RecordedSettings& settings, Pipeline& pipeline, HostTime now,
             Copier copier = &FusedMap::copy);
    ~Recorder() override;
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// A frame that goes to the pipeline next.
    void on_can(const wire::CanFrame& frame, WallTime stamp);
    /// Ends it if it is long enough, or has failed. To be called every now and then.
    void attend(HostTime now);
    /// What is recorded is complete now; the files become so soon after, see `wait`. Without the memory for a
    /// copy of the map it has failed, and `error` says so. `early`: why it ends though nobody asked for that
    /// and its time is not over; for a person.
    void stop(HostTime now, std::string early = {});
    /// The same with a `last_map` of before something changed the map.
    void stop(HostTime now, std::string early, std::optional<FusedMap> last_map);
    /// The map as it is now; empty if there is no memory for it, or what is recorded is complete already.
    [[nodiscard]] std::optional<FusedMap> last_map() const;
    /// Until the files are whole, after `stop`; false if `patience` was too short.
    [[nodiscard]] bool wait(Nanoseconds patience) { return writer_.wait(patience); }

    /// Why the folder was not taken: it is not empty, or somebody else's. Empty if it was; and if a disk
    /// takes longer than `patience` to tell, `error` says it then.
    [[nodiscard]] std::string refusal(Nanoseconds patience) { return writer_.refusal(patience); }

    /// It takes nothing more; its files may not be whole yet.
    [[nodiscard]] bool is_stopped() const { return stopped_.has_value(); }
    [[nodiscard]] bool has_ended() const { return writer_.has_ended(); }
    /// For a person; empty: all is well so far.
    [[nodiscard]] std::string error() const { return writer_.error(); }
    /// As RecordingWriter::writing_since.
    [[nodiscard]] std::optional<HostTime> writing_since() const { return writer_.writing_since(); }
    /// All that the map was made of could be recorded so far.
    [[nodiscard]] bool is_complete() const { return counts_.is_complete() && error().empty(); }
    [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
    [[nodiscard]] nlohmann::ordered_json to_json(HostTime now) const;

    void on_joints(const JointMeasurement& joints) override { put(joints); }
    void on_reading(const RangeMeasurement& measurement, const Beam& beam,
                    std::span<const VoxelUpdate> updates) override;
    void on_depth(const DepthFrame& frame, const Evidence& terms) override;
    void on_wait(const WaitCommit& passed) override { put(passed); }
    /// Ends it: its replay could not go on from there.
    void on_time_leap() override;

  private:
    void put(const Commit& commit);
    /// What was rejected since the begin, by name.
    [[nodiscard]] std::string remarks() const;
    /// Once it has: how it ended.
    void tell_end();

    Copier copier_;
    std::filesystem::path folder_;
    std::optional<Nanoseconds> limit_;
    std::size_t joints_;
    double depth_max_m_;
    HostTime begun_;
    std::optional<HostTime> stopped_;
    std::string early_;  ///< why it ended before it was to; empty: it did not
    bool is_end_told_ = false;
    Pipeline* pipeline_;
    std::vector<AccountTable> accounts_at_begin_;
    candump::LogEntry entry_;
    orderlog::Trailer counts_;
    std::uint64_t commits_before_ = 0;  ///< joint samples that the daemon had when it began
    std::uint64_t can_frames_ = 0;
    std::uint64_t depth_frames_ = 0;
    RecordingWriter writer_;
};

}  // namespace octoskin
