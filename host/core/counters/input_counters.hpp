// Counts the inputs of one kind and their results: in = used + rejected + pending. Each rejection has exactly
// one named reason.
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

/// `Reject` enumerates the reasons for a rejection. It counts from 0. Its namespace has an overload
/// `constexpr std::array<const char*, N> names_of(Reject)` in the order of the enumeration.
template <class Reject>
class InputCounters {
  public:
    static constexpr std::size_t kReasons = names_of(Reject{}).size();

    void count_in(std::uint64_t count = 1) noexcept { in_ += count; }
    void use() noexcept { ++used_; }
    /// Sets the place with which later rejections are recorded. The caller defines the number: a line, or a
    /// time in nanoseconds, for example.
    void now_at(std::int64_t place) noexcept { place_ = place; }
    void reject(Reject reason) noexcept {
        const auto index = static_cast<std::size_t>(reason);
        assert(index < kReasons);
        if (++rejected_[index] == 1) first_[index] = place_;
    }
    /// Counts one input as used or as rejected with the reason in `outcome`. Returns true if it was used.
    bool settle(const Status<Reject>& outcome) noexcept {
        outcome ? use() : reject(outcome.error());
        return outcome.has_value();
    }

    [[nodiscard]] std::uint64_t in() const noexcept { return in_; }
    [[nodiscard]] std::uint64_t used() const noexcept { return used_; }
    [[nodiscard]] std::uint64_t rejected(Reject reason) const noexcept {
        return rejected_[static_cast<std::size_t>(reason)];
    }
    /// The place of the first rejection for this reason. Valid only if there was one.
    [[nodiscard]] std::int64_t first_place(Reject reason) const noexcept {
        return first_[static_cast<std::size_t>(reason)];
    }
    [[nodiscard]] std::uint64_t rejected() const noexcept {
        std::uint64_t sum = 0;
        for (const std::uint64_t count : rejected_) {
            sum += count;
        }
        return sum;
    }
    /// `pending`: inputs that are counted but not resolved yet.
    [[nodiscard]] bool is_balanced(std::uint64_t pending = 0) const noexcept {
        return in_ == used_ + rejected() + pending;
    }

  private:
    std::uint64_t in_ = 0;
    std::uint64_t used_ = 0;
    std::array<std::uint64_t, kReasons> rejected_{};
    std::array<std::int64_t, kReasons> first_{};
    std::int64_t place_ = 0;
};

/// Formats a place that is a time in nanoseconds: "1750000000.123456 s".
[[nodiscard]] std::string seconds_text(std::int64_t ns);

/// The counters of one kind of input as rows of text and numbers, for printing and for JSON.
struct CounterTable {
    struct Row {
        std::string name;
        std::uint64_t count = 0;
        std::string first = {};  ///< place of the first rejection as text; empty: not known
    };
    std::string unit;     ///< what is counted: "frames", "readings"
    std::string of = {};  ///< the camera's name, if each of several has a table of this unit
    std::uint64_t in = 0;
    std::uint64_t used = 0;
    std::uint64_t pending = 0;
    std::vector<Row> rejected;  ///< all reasons in the order of the enumeration, also those with a count of 0
    bool is_balanced = false;

    /// "depth frames", "depth frames of left".
    [[nodiscard]] std::string title() const { return of.empty() ? unit : unit + std::string(kOf) + of; }
    static constexpr std::string_view kOf = " of ";
};

template <class Reject>
[[nodiscard]] CounterTable tabulate(std::string_view unit, const InputCounters<Reject>& inputs,
                                    std::uint64_t pending = 0) {
    CounterTable table{.unit = std::string(unit),
                       .in = inputs.in(),
                       .used = inputs.used(),
                       .pending = pending,
                       .rejected = {},
                       .is_balanced = inputs.is_balanced(pending)};
    constexpr auto kNames = names_of(Reject{});
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        table.rejected.push_back({kNames[i], inputs.rejected(static_cast<Reject>(i))});
    }
    return table;
}

/// The same, with the place of the first rejection of each reason. `place` converts a place to text.
template <class Reject, class Place>
[[nodiscard]] CounterTable tabulate(std::string_view unit, const InputCounters<Reject>& inputs,
                                    std::uint64_t pending, const Place& place) {
    CounterTable table = tabulate(unit, inputs, pending);
    for (std::size_t i = 0; i < table.rejected.size(); ++i) {
        if (table.rejected[i].count > 0)
            table.rejected[i].first = place(inputs.first_place(static_cast<Reject>(i)));
    }
    return table;
}

/// One line for the total, which is checked, and one for each reason with a count above 0:
///
///     readings               1020 in = 980 used + 40 rejected
///       status_fault           30
///       self_hit               10
[[nodiscard]] std::string to_text(const CounterTable& table);

}  // namespace octoskin
