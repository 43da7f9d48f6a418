// A clock that a restart of the daemon outlives, and when the map's time was what it is.
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

/// CLOCK_BOOTTIME as it is outside of any time namespace, which goes on while the machine sleeps, and of
/// which boot it is: as the kernel says, or, where a service may not see that, as systemd does in
/// OCTOSKIN_BOOT_ID. Empty: neither does. Some 10 us.
[[nodiscard]] std::optional<BootTime> boot_now();

/// By how much CLOCK_BOOTTIME of a time namespace is ahead of the one outside, from the text of
/// /proc/PID/timens_offsets; empty: it is something else.
[[nodiscard]] std::optional<Nanoseconds> read_boot_offset(std::string_view text);

/// 32 hexadecimal digits, with dashes or without; empty: it is something else.
[[nodiscard]] std::optional<std::array<std::uint8_t, 16>> read_boot_id(std::string_view text);

/// How many seconds passed, one that has begun included; empty: not known, as between two boots.
[[nodiscard]] std::optional<std::int64_t> seconds_between(const std::optional<BootTime>& then,
                                                          const std::optional<BootTime>& now);

[[nodiscard]] Nanoseconds clock_boottime();
[[nodiscard]] Nanoseconds clock_monotonic();

/// How long the machine sleeps: CLOCK_BOOTTIME goes on then, CLOCK_MONOTONIC does not.
class SleepWatch {
  public:
    using Clock = std::function<Nanoseconds()>;
    explicit SleepWatch(Clock boottime = clock_boottime, Clock monotonic = clock_monotonic);

    /// How long it slept since the last look, or since this was made; shorter sleeps add up to a second or
    /// more, and until then it is 0. Neither a processor that is not to be had nor a clock that is set
    /// counts.
    [[nodiscard]] Nanoseconds look();

  private:
    /// The time slept since the boot is between the two.
    struct Slept {
        Nanoseconds least{0};
        Nanoseconds most{0};
    };
    [[nodiscard]] Slept read() const;

    Clock boottime_;
    Clock monotonic_;
    Nanoseconds reported_;  ///< no less than what was slept when `look` last said something
};

/// When the map's clock came to what it shows, for the next start; and what makes the map older where no
/// measurement does.
class MapTime {
  public:
    using Clock = std::function<std::optional<BootTime>()>;
    explicit MapTime(Clock clock = boot_now, SleepWatch sleep = SleepWatch())
        : clock_(std::move(clock)), sleep_(std::move(sleep)) {}

    /// `map` goes on, whose time was what it is then; empty: that is not known. It grows older by as many
    /// seconds as have passed since then, which is the answer, and waits; if that is not known, all of it is
    /// stale, its time begins now, and the answer is empty.
    std::optional<std::int64_t> begin_with(FusedMap& map, const std::optional<BootTime>& saved);
    /// The same of a pipeline's map, whose times hold no more: all of it is stale, and its time begins now.
    void forget(Pipeline& pipeline);
    /// To be called every now and then. The pipeline's map grows older by what passes while it waits for its
    /// first measurement: of the program, or after the machine slept, which is noticed here: the map then
    /// waits as it does when the program begins, and the answer is how long it slept. Else the answer is 0.
    /// `bus`: what the bus's time is now, as well as it is known.
    Nanoseconds attend(Pipeline& pipeline, HostTime bus);
    /// How many seconds have passed since the map began to wait; empty: it never did, or that is not known.
    [[nodiscard]] std::optional<std::int64_t> since_saved() const {
        return seconds_between(saved_, clock_());
    }
    /// To be called every now and then: what changed since the last time did so after that, and was measured
    /// no earlier than in the second of the bus's time that the map's clock shows. `bus`: as `attend`.
    void note(const FusedMap& map, HostTime bus);
    /// No later than when it was; empty: not known.
    [[nodiscard]] const std::optional<BootTime>& map_time() const noexcept { return map_time_; }
    /// The map in a file is asked without this clock: a copy of it goes on to the bus's time first, where
    /// that is known and the map does not wait, as a copy that a question is put to does. The answer is the
    /// copy's `map_time`.
    [[nodiscard]] std::optional<BootTime> go_on(FusedMap& copy, HostTime bus) const;

  private:
    /// `map` waits since then.
    void begin(const FusedMap& map, const std::optional<BootTime>& since, const std::optional<BootTime>& now);
    void go_on_after_sleep(Pipeline& pipeline, HostTime bus, Nanoseconds slept);

    Clock clock_;
    SleepWatch sleep_;
    std::optional<BootTime> saved_;  ///< when the time of the map that waits, or waited last, was what it was
    std::optional<BootTime> looked_;
    std::optional<BootTime> map_time_;
    VoxelAges::Clock seen_;
};

}  // namespace octoskin
