// Finds the bricks with voxels that are too old, without visiting the other bricks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/voxels/morton.hpp"

namespace octoskin {

/// For each brick, a time stamp that is not later than that of any of its voxels; ten bytes. Voxels only
/// become newer, so the bound stays valid until the brick is visited. Copies of a map do not need it: a copy
/// of an agenda is empty.
class ExpiryAgenda {
  public:
    /// Maximum heap size of an entry, given the growth of vectors.
    static constexpr std::size_t kEntryBytes = 2 * (sizeof(MortonCode) + sizeof(std::uint16_t));

    ExpiryAgenda() = default;
    ExpiryAgenda(const ExpiryAgenda&) noexcept {}
    ExpiryAgenda(ExpiryAgenda&&) noexcept = default;
    ExpiryAgenda& operator=(const ExpiryAgenda&) = delete;
    ExpiryAgenda& operator=(ExpiryAgenda&&) noexcept = default;
    ~ExpiryAgenda() = default;

    [[nodiscard]] bool is_kept() const noexcept { return is_kept_; }
    void begin() noexcept { is_kept_ = true; }
    /// Makes room for one more brick, so that `put` does not throw. Throws std::bad_alloc.
    void make_room() {
        if (bricks_.size() == bricks_.capacity()) bricks_.reserve(2 * bricks_.size() + 16);
        if (oldest_.size() == oldest_.capacity()) oldest_.reserve(2 * oldest_.size() + 16);
    }
    /// Adds a brick that is not in the agenda. `oldest`: not later than any of its voxels.
    void put(MortonCode brick, std::uint16_t oldest) noexcept {
        bricks_.push_back(brick);
        oldest_.push_back(oldest);
    }

    /// Calls look(brick) for each brick whose time stamp is at least `first` and below `limit`. Also calls it
    /// for some other bricks, each within kRounds calls, so that bricks that were confirmed meanwhile do not
    /// all become due at once. `look` returns the earliest time stamp that the brick has now, or 0 if it has
    /// none, which removes the brick. Throws what `look` throws; the rest is then left to the next call.
    /// About 0.1 ns for each brick that is not visited.
    template <class Look>
    void look_at_due(std::uint16_t first, std::uint16_t limit, const Look& look) {
        const std::size_t ahead = bricks_.empty() ? 0 : bricks_.size() / kRounds + 1;
        for (std::size_t i = 0; i < ahead && !bricks_.empty(); ++i) {
            next_ = next_ < bricks_.size() ? next_ : 0;
            if (look_at(next_, look)) ++next_;
        }
        for (std::size_t i = 0; i < bricks_.size();) {
            const bool is_due = oldest_[i] >= first && oldest_[i] < limit;
            if (!is_due || look_at(i, look)) ++i;
        }
    }

    /// Replaces each time stamp; `change` keeps their order.
    template <class Change>
    void change_stamps(const Change& change) noexcept {
        std::ranges::transform(oldest_, oldest_.begin(), change);
    }
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return bricks_.size() * kEntryBytes; }

  private:
    static constexpr std::size_t kRounds = 64;

    /// False if the brick was removed and another one took its place.
    template <class Look>
    bool look_at(std::size_t place, const Look& look) {
        oldest_[place] = look(bricks_[place]);
        if (oldest_[place] != 0) return true;
        bricks_[place] = bricks_.back();
        oldest_[place] = oldest_.back();
        bricks_.pop_back();
        oldest_.pop_back();
        return false;
    }

    bool is_kept_ = false;
    std::size_t next_ = 0;  ///< the next brick to visit in advance
    std::vector<MortonCode> bricks_;
    std::vector<std::uint16_t> oldest_;
};

}  // namespace octoskin
