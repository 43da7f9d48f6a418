// When each voxel was last measured, and by which kind of sensor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "common/time.hpp"
#include "host/core/bricks/brick_stamps.hpp"
#include "host/core/bricks/brick_tree.hpp"
#include "host/core/mapping/expiry_agenda.hpp"
#include "host/core/voxels/sensor_kind.hpp"

namespace octoskin {

/// A voxel's last confirmation.
struct Confirmation {
    std::uint32_t age_s = 0;  ///< in whole seconds, exact to 1 s; `kAgeMax_s` for that age and above
    SensorKind kind = SensorKind::none;
    friend bool operator==(const Confirmation&, const Confirmation&) = default;
};

using StampTree = BrickTreeOf<std::uint16_t>;
using StampView = BrickViewOf<std::uint16_t>;

/// A clock in whole seconds, and its value at each voxel's last confirmation: 14 bits of time and two of
/// sensor kind. Copies share unchanged bricks, like copies of a BrickTree.
class VoxelAges {
  public:
    /// Largest age that is distinguished. When the clock exceeds its range, all time stamps are shifted, once
    /// in this many seconds.
    static constexpr std::uint32_t kAgeMax_s = 8191;

    /// The clock's state, for a snapshot.
    struct Clock {
        bool has_begun = false;
        bool waits = false;           ///< the next time is on a new scale
        std::int64_t runs_for_s = 0;  ///< whole seconds since it began
        std::int64_t waited_s = 0;    ///< of those, since it began to wait
        std::int64_t zero_s = 0;      ///< host time at which the clock's value would be 0, s
        std::uint32_t now = 0;        ///< the clock's value, at least 1: a time stamp of 0 means none
        friend bool operator==(const Clock&, const Clock&) = default;
    };

    VoxelAges() = default;
    /// Continues with another clock and its time stamps; the caller has checked them (`is_possible`).
    VoxelAges(const Clock& clock, StampTree stamps) noexcept : clock_(clock), stamps_(std::move(stamps)) {}
    [[nodiscard]] const Clock& clock() const noexcept { return clock_; }
    /// True if a clock can be in this state. O(1).
    [[nodiscard]] static bool is_possible(const Clock& clock) noexcept;
    /// True if a voxel can have this time stamp by that clock, which must be possible. A time stamp of 0
    /// means none, and is possible.
    [[nodiscard]] static bool is_possible(std::uint16_t stamp, const Clock& clock) noexcept;

    [[nodiscard]] bool has_begun() const noexcept { return clock_.has_begun; }
    /// Advances to `now`; the first call begins the clock. Measurements arrive late by fractions of a second:
    /// if `now` is earlier by up to `kBackMax_s`, the clock keeps its value. If it is earlier by more, the
    /// scale has changed, and ages continue from their values. True if the second changed. Throws
    /// std::bad_alloc at most once in kAgeMax_s seconds; the clock then keeps its value.
    bool advance_time(HostTime now);
    /// The whole seconds by which that would advance the clock; 0 if it has not begun or waits.
    [[nodiscard]] std::int64_t seconds_to(HostTime now) const noexcept;
    static constexpr std::int64_t kBackMax_s = 10;
    /// Time jump: the next time is ahead of the earlier scale by `by`, and no time has passed. Rounded to
    /// whole seconds.
    void jump_time(Nanoseconds by) noexcept;
    /// For a map that was saved: the next time is on a new scale, and ages continue from their values plus
    /// what `wait` adds. A clock that has not begun begins here.
    void begin_to_wait() noexcept {
        if (!clock_.has_begun) clock_ = {.has_begun = true, .now = kAgeMax_s};
        clock_.waits = true;
        clock_.waited_s = 0;
    }
    /// `seconds` in total have passed since `begin_to_wait`. Does nothing unless the clock has begun and
    /// waits, or if as many seconds were added before. True if ages grew. Throws as `advance_time`.
    bool wait(std::int64_t seconds);
    /// The time stamp of a voxel that is confirmed now. Lower values are earlier or, in the same second, of
    /// another kind.
    [[nodiscard]] std::uint16_t stamp(SensorKind kind) const noexcept {
        return static_cast<std::uint16_t>((clock_.now << kKindBits) | static_cast<std::uint16_t>(kind));
    }
    /// Time stamp of a voxel that was measured before the clock began, at an unknown time. Lower than all but
    /// 0.
    static constexpr std::uint16_t kOfBefore = 1U << 2U;
    /// Empty for a time stamp of 0 (none) and for kOfBefore.
    [[nodiscard]] std::optional<Confirmation> confirmation_of(std::uint16_t stamp) const noexcept;
    /// Time stamps below this one are `age_s` old or older, up to kAgeMax_s; 0 and kOfBefore always are.
    [[nodiscard]] std::uint16_t stamp_before(std::uint32_t age_s) const noexcept;
    /// Whole seconds since the clock began.
    [[nodiscard]] std::int64_t runs_for_s() const noexcept { return clock_.runs_for_s; }

    /// Confirms voxels of a brick. Throws std::bad_alloc; nothing is changed then. About 50 ns. If a copy
    /// shares the brick and anything changes, the brick is copied, too.
    void confirm(MortonCode brick, const BrickMask& voxels, SensorKind kind);
    /// Bricks with a time stamp for each voxel, for a caller that writes `stamp(kind)` itself. Valid until a
    /// brick is confirmed in another way.
    [[nodiscard]] StampTree::OwnBricks own_bricks() noexcept { return StampTree::OwnBricks(stamps_); }
    /// Gives kOfBefore to these voxels of a brick that have no time stamp. A brick without any time stamp
    /// gets it as a whole, which takes less memory. Throws std::bad_alloc; nothing is changed then.
    void take_from_before(MortonCode brick, const BrickMask& voxels);
    /// Removes the time stamps of some voxels of a brick. Throws std::bad_alloc; nothing is changed then.
    void forget(MortonCode brick, const BrickMask& voxels);

    /// Calls look(brick) for each brick that may have a time stamp of at least `first` and below `limit`, and
    /// for a few others. Throws what `look` throws. The first call builds the agenda of these bricks, which
    /// is O(time stamps) and may throw std::bad_alloc.
    template <class Look>
    void look_at_due(std::uint16_t first, std::uint16_t limit, const Look& look) {
        if (!agenda_.is_kept()) begin_agenda();
        agenda_.look_at_due(first, limit, [&](MortonCode brick) {
            look(brick);
            return oldest_in(brick);
        });
    }

    [[nodiscard]] StampView find(MortonCode brick) const noexcept { return stamps_.find(brick); }
    [[nodiscard]] const StampTree& stamps() const noexcept { return stamps_; }
    /// Bytes if every brick had its own time stamp for each voxel.
    [[nodiscard]] std::size_t bytes_at_most() const noexcept {
        return stamps_.nodes() * StampTree::kNodeBytes +
               stamps_.bricks() * (StampTree::kBrickBytes + ExpiryAgenda::kEntryBytes);
    }
    /// Upper bound of the bytes that a further brick takes.
    [[nodiscard]] std::size_t bytes_of_new(MortonCode brick) const noexcept {
        return stamps_.nodes_missing(brick) * StampTree::kNodeBytes + StampTree::kBrickBytes +
               ExpiryAgenda::kEntryBytes;
    }
    [[nodiscard]] std::size_t heap_bytes() const noexcept {
        return stamps_.memory_bytes() + agenda_.heap_bytes();
    }

  private:
    static constexpr unsigned kKindBits = 2;
    static constexpr std::uint32_t kNowMax = (1U << (16 - kKindBits)) - 1;
    /// Changes every time stamp; `change` must preserve their order. Throws std::bad_alloc; nothing is
    /// changed then.
    template <class Change>
    void change_stamps(const Change& change);
    void bring_up(std::uint32_t by);
    /// Advances the clock by `passed_s`, above 0. Throws std::bad_alloc; the clock then keeps its value.
    void advance(std::int64_t passed_s);
    void begin_agenda();
    /// The earliest time stamp; 0 if no voxel has one.
    [[nodiscard]] std::uint16_t oldest_in(MortonCode brick) const noexcept;
    /// Calls `stamp`, which gives time stamps to voxels of a brick that has none.
    template <class Stamp>
    void stamp_first(MortonCode brick, std::uint16_t with, const Stamp& stamp) {
        if (agenda_.is_kept()) agenda_.make_room();
        stamp();
        if (agenda_.is_kept()) agenda_.put(brick, with);
    }

    Clock clock_;
    StampTree stamps_;
    ExpiryAgenda agenda_;  ///< one entry for each brick with time stamps, after the first visit
};

}  // namespace octoskin
