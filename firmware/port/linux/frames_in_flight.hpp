// Frames that the kernel took and the bus has not confirmed. The limit is small, so that few frames are old
// when the bus returns; newer readings replace older ones in the node's queue.
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

    /// Also false while given-up frames have not been taken away.
    [[nodiscard]] bool has_room() const noexcept { return count_ < kMax; }
    /// Precondition: `has_room`.
    void add(const wire::CanFrame& frame, NodeTime now) noexcept;
    /// `frame` was sent. Frames keep their order, so earlier frames were sent too and their confirmations
    /// were lost. An unknown frame changes nothing.
    void confirm(const wire::CanFrame& frame) noexcept;
    /// Time at which the oldest unconfirmed frame was added.
    [[nodiscard]] std::optional<NodeTime> oldest() const noexcept;

    /// Marks all frames as given up: none of them will be sent.
    void give_up_all() noexcept { given_up_ = count_; }
    [[nodiscard]] std::optional<wire::CanFrame> take_given_up() noexcept;
    /// Removes all unconfirmed frames that were not given up. Returns their number.
    std::size_t forget_all() noexcept;

  private:
    struct Entry {
        wire::CanFrame frame;
        NodeTime added;
    };
    void drop_first(std::size_t count) noexcept;

    std::array<Entry, kMax> entries_{};  ///< oldest first; the first `given_up_` of them are given up
    std::size_t count_ = 0;
    std::size_t given_up_ = 0;
};

}  // namespace octoskin::linux_port
