// `octoskin record`: the inputs of the daemon and the updates of its map over a period.
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

/// The daemon's settings as text, so that a recording contains those in force, not the present content of the
/// files.
struct RecordedSettings {
    std::string rig;
    std::string robot;
    std::string mapping;
    std::uint32_t rig_hash = 0;
    std::uint32_t placement_crc32 = 0;  ///< rig::placement_crc32
    orderlog::CommitForm form = {};
    std::vector<std::string> cameras = {};  ///< their names
    std::vector<std::string> devices = {};  ///< of the cameras; not part of a recording
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

    /// Starts with the pipeline in any state, and changes only its listener: the map is updated as without a
    /// recording. `pipeline` must outlive the recording: until `stop`. Does not wait: a fault of the folder
    /// appears in `error`. Throws std::bad_alloc if there is no memory for a copy of the map,
    /// std::system_error if there is no thread left; the pipeline is then unchanged.
    Recorder(const std::filesystem::path& folder, std::optional<Nanoseconds> limit,
             const RecordedSettings& settings, Pipeline& pipeline, HostTime now,
             Copier copier = &FusedMap::copy);
    ~Recorder() override;
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Notes a frame that goes to the pipeline next.
    void on_can(const wire::CanFrame& frame, WallTime stamp);
    /// Ends the recording if it is long enough, or has failed. Call this regularly.
    void attend(HostTime now);
    /// Ends the input; the files are complete soon after, see `wait`. Without memory for a copy of the map
    /// the recording has failed, with an `error`. `early`: the reason if it ends before its time and without
    /// a request; for a person.
    void stop(HostTime now, std::string early = {});
    /// The same with a `last_map` from before a change of the map.
    void stop(HostTime now, std::string early, std::optional<FusedMap> last_map);
    /// The present map; empty if there is no memory for it, or the input has ended.
    [[nodiscard]] std::optional<FusedMap> last_map() const;
    /// Waits until the files are complete, after `stop`; false if `patience` was too short.
    [[nodiscard]] bool wait(Nanoseconds patience) { return writer_.wait(patience); }

    /// Why the folder was refused: it is not empty, or belongs to another user. Empty if it was accepted. If
    /// a disk takes longer than `patience`, `error` has it then.
    [[nodiscard]] std::optional<Error> refusal(Nanoseconds patience) { return writer_.refusal(patience); }

    /// It accepts no more input; its files may not be complete yet.
    [[nodiscard]] bool is_stopped() const { return stopped_.has_value(); }
    [[nodiscard]] bool has_ended() const { return writer_.has_ended(); }
    /// For a person; empty: no error so far.
    [[nodiscard]] std::string error() const {
        const auto error = writer_.error();
        return error ? error->message() : std::string();
    }
    /// As RecordingWriter::writing_since.
    [[nodiscard]] std::optional<HostTime> writing_since() const { return writer_.writing_since(); }
    /// All that went into the map could be recorded so far, and the map took it as a replay will.
    [[nodiscard]] bool is_complete() const { return counts_.is_complete() && !writer_.error(); }
    [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
    [[nodiscard]] nlohmann::ordered_json to_json(HostTime now) const;

    void on_joints(const JointMeasurement& joints) override { put(joints); }
    void on_reading(const RangeMeasurement& measurement, const Beam& beam,
                    std::span<const VoxelUpdate> updates) override;
    void on_depth(const DepthFrame& frame, const Evidence& terms) override;
    void on_wait(const WaitCommit& passed) override;
    void on_broken_off() noexcept override { lose(); }
    /// Ends the recording: its replay could not continue from there.
    void on_time_jump() override;

  private:
    void put(const Commit& commit);
    [[nodiscard]] std::uint64_t depth_frames() const noexcept;
    /// Counts a commit that is not in the recording.
    void lose() noexcept;
    /// True if the system has lacked memory for the map since the last call: a replay, which has it, gives
    /// another map.
    [[nodiscard]] bool has_map_lacked_memory() noexcept;
    /// Counts of rejected inputs since the start, by name.
    [[nodiscard]] std::string remarks() const;
    /// Logs the result once it has ended.
    void report_end();

    Copier copier_;
    std::filesystem::path folder_;
    std::optional<Nanoseconds> limit_;
    orderlog::CommitForm form_;
    std::vector<double> depths_max_m_;  ///< of each camera
    HostTime begun_;
    std::optional<HostTime> stopped_;
    std::string early_;  ///< why it ended before its time; empty: it did not
    bool is_end_reported_ = false;
    Pipeline* pipeline_;
    std::vector<CounterTable> inputs_at_begin_;
    candump::LogEntry entry_;
    orderlog::Trailer counts_;
    std::uint64_t lacks_ = 0;           ///< times that the system had no memory for the map, ever
    std::uint64_t commits_before_ = 0;  ///< joint samples in the daemon at the start
    std::uint64_t can_frames_ = 0;
    std::vector<std::uint64_t> depth_frames_;  ///< of each camera
    RecordingWriter writer_;
};

}  // namespace octoskin
