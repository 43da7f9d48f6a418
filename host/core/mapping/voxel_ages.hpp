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
    std::uint32_t age_s = 0;  ///< whole seconds, to 1 s; `kAgeMax_s` if it is that long ago or longer
    SensorKind kind = SensorKind::none;
    friend bool operator==(const Confirmation&, const Confirmation&) = default;
};

using StampTree = BrickTreeOf<std::uint16_t>;
using StampView = BrickViewOf<std::uint16_t>;

/// A clock of whole seconds, and its reading for each voxel: 14 bits, and two of the kind. Copies share what
/// they have in common, as a BrickTree's do.
class VoxelAges {
  public:
    /// As far back as ages are told apart. A clock that runs further brings all stamps up with it, once in as
    /// many seconds.
    static constexpr std::uint32_t kAgeMax_s = 8191;

    /// What the clock is made of, for a snapshot of it.
    struct Clock {
        bool has_begun = false;
        bool waits = false;           ///< the time that comes next begins a scale of its own
        std::int64_t runs_for_s = 0;  ///< whole seconds since it began
        std::int64_t waited_s = 0;    ///< of those, since it waits
        std::int64_t zero_s = 0;      ///< of the host's time, at which it would show 0
        std::uint32_t now = 0;        ///< what it shows, from 1 on: a stamp of 0 is none
        friend bool operator==(const Clock&, const Clock&) = default;
    };

    VoxelAges() = default;
    /// Goes on with the clock and the stamps of others; the caller has checked them (`is_possible`).
    VoxelAges(const Clock& clock, StampTree stamps) noexcept : clock_(clock), stamps_(std::move(stamps)) {}
    [[nodiscard]] const Clock& clock() const noexcept { return clock_; }
    /// Whether a clock can have come to be so. O(1).
    [[nodiscard]] static bool is_possible(const Clock& clock) noexcept;
    /// Whether a voxel can have this stamp by that clock, which is possible; 0 is none, and is possible.
    [[nodiscard]] static bool is_possible(std::uint16_t stamp, const Clock& clock) noexcept;

    [[nodiscard]] bool has_begun() const noexcept { return clock_.has_begun; }
    /// Time goes on to `now`, or, the first time, begins. Measurements come late by fractions of a second:
    /// the clock waits for what is earlier by up to `kBackMax_s`; beyond, the time is another one from then
    /// on, and ages go on from what they were. True if it is another second than before. Throws
    /// std::bad_alloc once in kAgeMax_s seconds at most; then the clock stands.
    bool go_on(HostTime now);
    static constexpr std::int64_t kBackMax_s = 10;
    /// The time that comes next is ahead by this of the one so far, and none of it has passed. To whole
    /// seconds.
    void leap(Nanoseconds by) noexcept;
    /// Of a map that was saved: the time that comes next begins a scale of its own, and ages go on from what
    /// they were and from what `wait` adds to them. A clock that has not begun begins with that.
    void begin_to_wait() noexcept {
        if (!clock_.has_begun) clock_ = {.has_begun = true, .now = kAgeMax_s};
        clock_.waits = true;
        clock_.waited_s = 0;
    }
    /// So many seconds have passed since `begin_to_wait`, in all. Nothing unless the clock waits and has
    /// begun, or if as many or more were added already. True if ages grew. Throws as `go_on`.
    bool wait(std::int64_t seconds);
    /// What a voxel that is confirmed now is given. The lower, the weaker: earlier, of another sensor.
    [[nodiscard]] std::uint16_t stamp(SensorKind kind) const noexcept {
        return static_cast<std::uint16_t>((clock_.now << kKindBits) | static_cast<std::uint16_t>(kind));
    }
    /// Of a voxel that was there when the clock began: nobody knows since when. Lower than all but 0.
    static constexpr std::uint16_t kOfBefore = 1U << 2U;
    /// Empty for a stamp of 0, which is none, and for kOfBefore.
    [[nodiscard]] std::optional<Confirmation> confirmation_of(std::uint16_t stamp) const noexcept;
    /// Stamps below this one are `age_s` old or older, up to kAgeMax_s; 0 and kOfBefore always are.
    [[nodiscard]] std::uint16_t stamp_before(std::uint32_t age_s) const noexcept;
    /// Whole seconds since the clock began.
    [[nodiscard]] std::int64_t runs_for_s() const noexcept { return clock_.runs_for_s; }

    /// Confirms voxels of a brick. Throws std::bad_alloc, and then nothing is changed. About 50 ns, and as
    /// much as a copy of the brick if a copy has it, too, and anything changes.
    void confirm(MortonCode brick, const BrickMask& voxels, SensorKind kind);
    /// Bricks whose stamps have a place each, for a caller that gives them `stamp(kind)` itself; until a
    /// brick is confirmed otherwise.
    [[nodiscard]] StampTree::OwnBricks own_bricks() noexcept { return StampTree::OwnBricks(stamps_); }
    /// These voxels of a brick were there when the clock began, if they have no stamp: all of the brick if it
    /// has none, which takes less. Throws std::bad_alloc, and then nothing is changed.
    void take_from_before(MortonCode brick, const BrickMask& voxels);
    /// Makes some voxels of a brick unconfirmed. Throws std::bad_alloc, and then nothing is changed.
    void forget(MortonCode brick, const BrickMask& voxels);

    /// Calls look(brick) for each brick that may have a stamp from `first` on and before `limit`, and for a
    /// few others. Throws what it does, and std::bad_alloc the first time, which is O(stamps): from then on
    /// it is known which bricks these may be.
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
    /// If every brick had a stamp of its own for each voxel.
    [[nodiscard]] std::size_t bytes_at_most() const noexcept {
        return stamps_.nodes() * StampTree::kNodeBytes +
               stamps_.bricks() * (StampTree::kBrickBytes + ExpiryAgenda::kEntryBytes);
    }
    /// What a further brick may take.
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
    /// Changes every stamp that is there; `change` keeps their order. Throws std::bad_alloc, and then nothing
    /// is changed.
    template <class Change>
    void change_stamps(const Change& change);
    void bring_up(std::uint32_t by);
    /// Makes the clock show so much more, `passed_s` above 0. Throws std::bad_alloc; then it shows the same.
    void advance(std::int64_t passed_s);
    void begin_agenda();
    /// The earliest stamp; 0 if no voxel has one.
    [[nodiscard]] std::uint16_t oldest_in(MortonCode brick) const noexcept;
    /// Makes `stamp` give stamps to voxels of a brick that has none.
    template <class Stamp>
    void stamp_first(MortonCode brick, std::uint16_t with, const Stamp& stamp) {
        if (agenda_.is_kept()) agenda_.make_room();
        stamp();
        if (agenda_.is_kept()) agenda_.put(brick, with);
    }

    Clock clock_;
    StampTree stamps_;
    ExpiryAgenda agenda_;  ///< of each brick that has stamps, once somebody asked
};

}  // namespace octoskin
