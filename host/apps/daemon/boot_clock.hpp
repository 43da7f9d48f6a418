// A clock that a restart of the daemon outlives, and when the map's time was what it is.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "host/core/mapping/fused_map.hpp"
#include "host/io/snapshot/snapshot.hpp"

namespace octoskin {

/// CLOCK_BOOTTIME, which goes on while the machine sleeps, and of which boot it is: as the kernel says, or,
/// where a service may not see that, as systemd does in OCTOSKIN_BOOT_ID. Empty: neither does.
[[nodiscard]] std::optional<BootTime> boot_now();

/// 32 hexadecimal digits, with dashes or without; empty: it is something else.
[[nodiscard]] std::optional<std::array<std::uint8_t, 16>> read_boot_id(std::string_view text);

/// How many seconds passed, one that has begun included; empty: not known, as between two boots.
[[nodiscard]] std::optional<std::int64_t> seconds_between(const std::optional<BootTime>& then,
                                                          const std::optional<BootTime>& now);

/// When the map's clock came to what it shows, for the next start.
class MapTime {
  public:
    using Clock = std::function<std::optional<BootTime>()>;
    explicit MapTime(Clock clock = boot_now) : clock_(std::move(clock)) {}

    /// `map` goes on, whose time was what it is then; empty: that is not known. It grows older by as many
    /// seconds as have passed since then, which is the answer, and waits; if that is not known, all of it is
    /// stale, and the answer empty. Throws std::bad_alloc.
    std::optional<std::int64_t> begin_with(FusedMap& map, const std::optional<BootTime>& saved);
    /// How many seconds have passed since then; empty: that is not known.
    [[nodiscard]] std::optional<std::int64_t> since_saved() const {
        return seconds_between(saved_, clock_());
    }
    /// To be called every now and then: what changed since the last time did so after that.
    void note(const FusedMap& map);
    /// No later than when it was; empty: not known.
    [[nodiscard]] const std::optional<BootTime>& map_time() const noexcept { return map_time_; }

  private:
    Clock clock_;
    std::optional<BootTime> saved_;
    std::optional<BootTime> looked_;
    std::optional<BootTime> map_time_;
    VoxelAges::Clock seen_;
};

}  // namespace octoskin
