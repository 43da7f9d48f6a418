// Frames that the kernel took and the bus has not confirmed. Few, so that little is stale when the bus comes
// back, and the newest reading wins where it can: in the node's queue.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"

namespace octoskin::linux_port {

class FramesInFlight {
  public:
    static constexpr std::size_t kMax = 4;

    /// Also false while what was given up was not taken away.
    [[nodiscard]] bool has_room() const noexcept { return count_ < kMax; }
    /// `has_room` must hold.
    void add(const wire::CanFrame& frame, NodeTime now) noexcept;
    /// The bus has had `frame`; with it those before it, whose confirmation was lost: frames keep their
    /// order. One that is not known changes nothing.
    void confirm(const wire::CanFrame& frame) noexcept;
    /// When the oldest that is not confirmed was added.
    [[nodiscard]] std::optional<NodeTime> oldest() const noexcept;

    /// None of them will be sent.
    void give_up_all() noexcept { given_up_ = count_; }
    [[nodiscard]] std::optional<wire::CanFrame> take_given_up() noexcept;
    /// Nobody knows what became of them. How many they were.
    std::size_t forget_all() noexcept;

  private:
    struct Entry {
        wire::CanFrame frame;
        NodeTime added;
    };
    void drop_first(std::size_t count) noexcept;

    std::array<Entry, kMax> entries_{};  ///< the oldest first; of these the first `given_up_` are given up
    std::size_t count_ = 0;
    std::size_t given_up_ = 0;
};

}  // namespace octoskin::linux_port
