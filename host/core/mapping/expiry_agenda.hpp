// Which of many bricks have voxels that are too old, without looking into the others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/voxels/morton.hpp"

namespace octoskin {

/// Of each brick a stamp that is no later than any of its voxels', ten bytes. Voxels are only ever confirmed,
/// so that it holds until somebody looks. Copies of a map do without: a copy of an agenda is none.
class ExpiryAgenda {
  public:
    /// What an entry takes of the heap at most, as vectors grow.
    static constexpr std::size_t kEntryBytes = 2 * (sizeof(MortonCode) + sizeof(std::uint16_t));

    ExpiryAgenda() = default;
    ExpiryAgenda(const ExpiryAgenda&) noexcept {}
    ExpiryAgenda(ExpiryAgenda&&) noexcept = default;
    ExpiryAgenda& operator=(const ExpiryAgenda&) = delete;
    ExpiryAgenda& operator=(ExpiryAgenda&&) noexcept = default;
    ~ExpiryAgenda() = default;

    [[nodiscard]] bool is_kept() const noexcept { return is_kept_; }
    void begin() noexcept { is_kept_ = true; }
    /// Of one more brick; then `put` one does not throw. Throws std::bad_alloc.
    void make_room() {
        if (bricks_.size() == bricks_.capacity()) bricks_.reserve(2 * bricks_.size() + 16);
        if (oldest_.size() == oldest_.capacity()) oldest_.reserve(2 * oldest_.size() + 16);
    }
    /// A brick that is not there. `oldest`: no voxel's is earlier.
    void put(MortonCode brick, std::uint16_t oldest) noexcept {
        bricks_.push_back(brick);
        oldest_.push_back(oldest);
    }

    /// Calls look(brick) for each whose stamp is `first` or later and before `limit`, and for some others, so
    /// that of those that were confirmed meanwhile not many come at once: each within kRounds calls. It
    /// answers the earliest stamp that the brick has now, 0 if it has none: then the brick leaves. Throws
    /// what `look` does, and then some are left to the next call. Some 0.1 ns for each that is not looked at.
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

    /// Each stamp becomes another one, in the same order.
    template <class Change>
    void change_stamps(const Change& change) noexcept {
        std::ranges::transform(oldest_, oldest_.begin(), change);
    }
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return bricks_.size() * kEntryBytes; }

  private:
    static constexpr std::size_t kRounds = 64;

    /// False if the brick left, and another one took its place.
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
    std::size_t next_ = 0;  ///< to be looked at ahead
    std::vector<MortonCode> bricks_;
    std::vector<std::uint16_t> oldest_;
};

}  // namespace octoskin
