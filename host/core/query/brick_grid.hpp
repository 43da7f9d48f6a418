// Stores objects for the bricks of a box, found by the coordinates of a brick.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "host/core/bricks/brick_box.hpp"

namespace octoskin {

/// Takes 8 bytes for each brick of the box, plus the objects.
template <class Thing>
class BrickGrid {
  public:
    explicit BrickGrid(const BrickBox& box) : box_(box), things_(box.bricks()) {}

    [[nodiscard]] const BrickBox& box() const noexcept { return box_; }
    /// Linear index of a brick of the box.
    [[nodiscard]] std::size_t index(const BrickPlace& place) const noexcept { return box_.index(place); }
    [[nodiscard]] BrickPlace place(std::size_t index) const noexcept {
        const auto from = [&](std::size_t axis, std::size_t steps) {
            return box_.lowest.at[axis] + static_cast<int>(steps % box_.edge(axis));
        };
        return {
            {from(0, index), from(1, index / box_.edge(0)), from(2, index / (box_.edge(0) * box_.edge(1)))}};
    }
    /// Null if there is no object, or the brick is outside the box.
    [[nodiscard]] const Thing* find(const BrickPlace& place) const noexcept {
        return box_.holds(place) ? things_[index(place)].get() : nullptr;
    }
    [[nodiscard]] const Thing* operator[](std::size_t index) const noexcept { return things_[index].get(); }
    /// The object at the index; if there is none, a copy of `otherwise` is stored and returned.
    [[nodiscard]] Thing& open(std::size_t index, const Thing& otherwise) {
        if (!things_[index]) {
            things_[index] = std::make_unique<Thing>(otherwise);
            ++count_;
        }
        return *things_[index];
    }
    void take_away(std::size_t index) noexcept {
        count_ -= things_[index] ? 1U : 0U;
        things_[index].reset();
    }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        constexpr std::size_t kOfHeap = 16;  // approximate overhead of an allocation
        return things_.size() * sizeof(things_[0]) + count_ * (sizeof(Thing) + kOfHeap);
    }

  private:
    BrickBox box_;
    std::vector<std::unique_ptr<Thing>> things_;
    std::size_t count_ = 0;
};

}  // namespace octoskin
