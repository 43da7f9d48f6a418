// The promise that nothing vanishes: of every kind of input, in = used + sum of rejected, each rejection
// under exactly one name.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"

namespace octoskin {

/// Names one reason for a rejection. A `Reject` enumeration counts from 0 and comes with an overload
/// `constexpr std::array<const char*, N> names_of(Reject)` in its own namespace, in the enumeration's order.
template <class Reject>
class Account {
  public:
    static constexpr std::size_t kReasons = names_of(Reject{}).size();

    void take_in(std::uint64_t count = 1) noexcept { in_ += count; }
    void use() noexcept { ++used_; }
    void reject(Reject reason) noexcept {
        assert(static_cast<std::size_t>(reason) < kReasons);
        ++rejected_[static_cast<std::size_t>(reason)];
    }
    /// Uses or rejects one, as it turned out. True if it was used.
    bool settle(const Status<Reject>& outcome) noexcept {
        outcome ? use() : reject(outcome.error());
        return outcome.has_value();
    }

    [[nodiscard]] std::uint64_t in() const noexcept { return in_; }
    [[nodiscard]] std::uint64_t used() const noexcept { return used_; }
    [[nodiscard]] std::uint64_t rejected(Reject reason) const noexcept {
        return rejected_[static_cast<std::size_t>(reason)];
    }
    [[nodiscard]] std::uint64_t rejected() const noexcept {
        std::uint64_t sum = 0;
        for (const std::uint64_t count : rejected_) {
            sum += count;
        }
        return sum;
    }
    /// `pending`: inputs taken in whose fate is still open, counted where they wait.
    [[nodiscard]] bool is_balanced(std::uint64_t pending = 0) const noexcept {
        return in_ == used_ + rejected() + pending;
    }

  private:
    std::uint64_t in_ = 0;
    std::uint64_t used_ = 0;
    std::array<std::uint64_t, kReasons> rejected_{};
};

/// One account as rows of text and numbers, for printing and for JSON.
struct AccountTable {
    struct Row {
        std::string name;
        std::uint64_t count = 0;
    };
    std::string unit;  ///< what is counted: "frames", "readings"
    std::uint64_t in = 0;
    std::uint64_t used = 0;
    std::uint64_t pending = 0;
    std::vector<Row> rejected;  ///< every reason, zero counts included, in the enumeration's order
    bool is_balanced = false;
};

template <class Reject>
[[nodiscard]] AccountTable tabulate(std::string_view unit, const Account<Reject>& account,
                                    std::uint64_t pending = 0) {
    AccountTable table{.unit = std::string(unit),
                       .in = account.in(),
                       .used = account.used(),
                       .pending = pending,
                       .rejected = {},
                       .is_balanced = account.is_balanced(pending)};
    constexpr auto kNames = names_of(Reject{});
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        table.rejected.push_back({kNames[i], account.rejected(static_cast<Reject>(i))});
    }
    return table;
}

/// Lines of text, one per non-zero reason, the sum checked:
///
///     readings               1020 in = 980 used + 40 rejected
///       status_fault           30
///       self_hit               10
[[nodiscard]] std::string to_text(const AccountTable& table);

}  // namespace octoskin
