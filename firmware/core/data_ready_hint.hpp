// What one bus's data-ready line has to say, as far as it can be believed. A fall that no sensor's data
// answers to is spurious; a line that brings mostly such falls is not listened to any more.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ports.hpp"

namespace octoskin::node {

class DataReadyHint {
  public:
    /// `lines`: null for a bus without a line, which never hints. Both must outlive the hint.
    DataReadyHint(DataReadyLines* lines, std::uint8_t bus, const Policy& policy) noexcept
        : lines_(lines), bus_(bus), policy_(policy) {}

    /// Whether the line fell, once for each fall; asked at most every `Policy::hint_interval`.
    [[nodiscard]] bool take(NodeTime now);
    /// A sensor that was asked because of the last hint had data.
    void confirm() noexcept;

    /// The last hint may have been for a sensor that is not read by hints.
    void excuse() noexcept { is_unconfirmed_ = false; }

    /// Too many falls were spurious: not asked again before the node's next start.
    [[nodiscard]] bool is_ignored() const noexcept { return doubt_ >= policy_.hint_doubt_max; }
    /// Falls that meant nothing, since start.
    [[nodiscard]] std::uint32_t spurious_count() const noexcept { return spurious_count_; }

  private:
    DataReadyLines* lines_;
    std::uint8_t bus_;
    const Policy& policy_;
    std::optional<NodeTime> asked_again_at_;  ///< after a fall
    bool is_unconfirmed_ = false;
    std::uint16_t doubt_ = 0;  ///< grows with spurious falls, shrinks with confirmed ones
    std::uint32_t spurious_count_ = 0;
};

}  // namespace octoskin::node
