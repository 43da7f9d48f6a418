// A clock that continues over a restart of the daemon, and the point on it at which the map had its time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "common/time.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/io/snapshot/snapshot.hpp"

namespace octoskin {

/// CLOCK_BOOTTIME as it is outside of any time namespace, which also runs while the machine sleeps, and the
/// id of the boot: from the kernel or, if a service may not read that, from systemd in OCTOSKIN_BOOT_ID.
/// Empty: from neither. Cost: some 10 us.
[[nodiscard]] std::optional<BootTime> boot_now();

/// The offset of CLOCK_BOOTTIME of a time namespace against the one outside, from the text of
/// /proc/PID/timens_offsets; empty: the text is not of this form.
[[nodiscard]] std::optional<Nanoseconds> read_boot_offset(std::string_view text);

/// Reads 32 hexadecimal digits, with dashes or without; empty: the text is not of this form.
[[nodiscard]] std::optional<std::array<std::uint8_t, 16>> read_boot_id(std::string_view text);

/// Seconds passed, rounded up; empty: not known, as between two boots.
[[nodiscard]] std::optional<std::int64_t> seconds_between(const std::optional<BootTime>& then,
                                                          const std::optional<BootTime>& now);

[[nodiscard]] Nanoseconds clock_boottime();
[[nodiscard]] Nanoseconds clock_monotonic();

/// How long the machine slept: CLOCK_BOOTTIME runs then, CLOCK_MONOTONIC does not.
class SleepWatch {
  public:
    using Clock = std::function<Nanoseconds()>;
    explicit SleepWatch(Clock boottime = clock_boottime, Clock monotonic = clock_monotonic);

    /// The time slept since the last call, or since construction. Shorter sleeps add up to a second or more,
    /// and until then the result is 0. Neither lack of processor time nor a set clock counts as sleep.
    [[nodiscard]] Nanoseconds look();

  private:
    /// Bounds of the time slept since the boot.
    struct Slept {
        Nanoseconds least{0};
        Nanoseconds most{0};
    };
    [[nodiscard]] Slept read() const;

    Clock boottime_;
    Clock monotonic_;
    Nanoseconds reported_;  ///< at least the time slept when `look` last returned more than 0
};

/// When the map's clock reached its present value, for the next start; and how the map ages when no
/// measurement advances its time.
class MapTime {
  public:
    using Clock = std::function<std::optional<BootTime>()>;
    explicit MapTime(Clock clock = boot_now, SleepWatch sleep = SleepWatch())
        : clock_(std::move(clock)), sleep_(std::move(sleep)) {}

    /// Continues with `map`, which had its time at `saved`; empty: not known. The map ages by the seconds
    /// passed since then, which are returned, and waits for its first measurement. If they are not known, all
    /// of the map is stale, its time begins now, and the result is empty.
    std::optional<std::int64_t> begin_with(FusedMap& map, const std::optional<BootTime>& saved);
    /// The same for a pipeline's map whose times are no longer valid: all of it is stale, and its time begins
    /// now.
    void forget(Pipeline& pipeline);
    /// Call this regularly. While the pipeline's map waits for its first measurement, it ages by the time
    /// that passes: after a start of the program, or after a sleep of the machine, which this function
    /// detects. After a sleep the map waits as after a start, and the result is the time slept; otherwise it
    /// is 0. `bus`: the best estimate of the present bus time.
    Nanoseconds attend(Pipeline& pipeline, HostTime bus);
    /// Seconds passed since the map began to wait; empty: it never did, or that is not known.
    [[nodiscard]] std::optional<std::int64_t> since_saved() const {
        return seconds_between(saved_, clock_());
    }
    /// Call this regularly. Assumes that changes since the last call happened after it, and were measured no
    /// earlier than in the second of the bus time that the map's clock shows. `bus`: as for `attend`.
    void note(const FusedMap& map, HostTime bus);
    /// No later than the true value; empty: not known.
    [[nodiscard]] const std::optional<BootTime>& map_time() const noexcept { return map_time_; }
    /// A map in a file is queried without this clock. So the time of a copy is first advanced to the bus
    /// time, if that is known and the map does not wait, as for a copy that a query uses. Returns the copy's
    /// `map_time`.
    [[nodiscard]] std::optional<BootTime> advance_time(FusedMap& copy, HostTime bus) const;

  private:
    /// `map` has waited since `since`.
    void begin(const FusedMap& map, const std::optional<BootTime>& since, const std::optional<BootTime>& now);
    void jump_over_sleep(Pipeline& pipeline, HostTime bus, Nanoseconds slept);

    Clock clock_;
    SleepWatch sleep_;
    std::optional<BootTime> saved_;  ///< when the map that waits, or waited last, had its time
    std::optional<BootTime> looked_;
    std::optional<BootTime> map_time_;
    VoxelAges::Clock seen_;
};

}  // namespace octoskin
