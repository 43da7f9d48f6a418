// Holds measurements until everything measured before them has had time to arrive.
#pragma once

#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"

namespace octoskin {

/// The order in which measurements enter the map. A camera's source is node 0.
struct ReleaseKey {
    HostTime captured;
    BeamSource source;
    friend constexpr auto operator<=>(const ReleaseKey&, const ReleaseKey&) = default;
};

template <class T>
class ReorderBuffer {
  public:
    explicit ReorderBuffer(std::size_t capacity) : capacity_(capacity) { assert(capacity > 0); }

    enum class Pushed : std::uint8_t {
        waits,
        displaced,  ///< waits; the oldest was dropped to make room
        refused,    ///< one with the same key already waits
    };
    /// O(log size).
    [[nodiscard]] Pushed push(const ReleaseKey& key, T value) {
        if (!waiting_.try_emplace(key, std::move(value)).second) {
            return Pushed::refused;
        }
        if (waiting_.size() <= capacity_) {
            return Pushed::waits;
        }
        waiting_.erase(waiting_.begin());
        return Pushed::displaced;
    }
    /// True if a measurement of the same source waits that was captured less than `apart` before or after.
    [[nodiscard]] bool has_near(const ReleaseKey& key, Nanoseconds apart) const {
        for (auto it = waiting_.lower_bound({key.captured - apart, {}});
             it != waiting_.end() && it->first.captured < key.captured + apart; ++it) {
            if (it->first.source == key.source && it->first.captured > key.captured - apart) {
                return true;
            }
        }
        return false;
    }
    [[nodiscard]] bool is_full() const noexcept { return waiting_.size() >= capacity_; }
    /// The key of the oldest measurement.
    [[nodiscard]] std::optional<ReleaseKey> front() const {
        return waiting_.empty() ? std::nullopt : std::optional(waiting_.begin()->first);
    }
    /// The oldest measurement; there must be one.
    [[nodiscard]] T pop() {
        assert(!waiting_.empty());
        return std::move(waiting_.extract(waiting_.begin()).mapped());
    }
    [[nodiscard]] std::size_t size() const noexcept { return waiting_.size(); }

  private:
    std::size_t capacity_;
    std::map<ReleaseKey, T> waiting_;
};

}  // namespace octoskin
