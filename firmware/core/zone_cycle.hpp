// Which zone a range was taken in. A zone written while the sensor ranges takes effect with the next range
// (UM2555), so a reading has the zone in force when its range began. Too close to a write the zone is
// unknown.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

class ZoneCycle {
  public:
    ZoneCycle(std::uint8_t zone_count, Microseconds guard) noexcept;

    /// The sensor was configured again, with zone 0.
    void restart() noexcept;
    /// Ranging starts: the zone last written is in force, however long ago it was written.
    void settle() noexcept;

    [[nodiscard]] bool is_cycling() const noexcept { return zone_count_ > 1; }
    /// The zone last written.
    [[nodiscard]] std::uint8_t current() const noexcept { return after_; }
    /// The zone to write next.
    [[nodiscard]] std::uint8_t next() const noexcept;
    /// Whether a write begun at `now` ends, with the guard, before the next range begins.
    [[nodiscard]] bool fits_before(NodeTime next_range_begin, NodeTime now) const noexcept;

    /// `next()` was written within `when`, and is in force from then on.
    void written(const TimeBracket& when) noexcept;

    /// A range that began at `earliest` or later was judged; all later ones begin later. A write from before
    /// it is settled: kept for half an hour, its time would lie in the future.
    void note_range(NodeTime earliest) noexcept;

    /// The zone of a range that began within `begin`; `wire::kZoneUnknown` within the guard of a write.
    [[nodiscard]] std::uint8_t in_force(const TimeBracket& begin) const noexcept;

  private:
    std::uint8_t zone_count_;
    Microseconds guard_;
    std::uint8_t before_ = 0;  ///< in force before the last write
    std::uint8_t after_ = 0;   ///< in force after it
    std::optional<TimeBracket> write_;
};

}  // namespace octoskin::node
