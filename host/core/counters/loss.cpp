#include "host/core/counters/loss.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "host/core/counters/counter_meanings.hpp"

namespace octoskin {
namespace {

Cause cause_of(const std::string& unit, const CounterTable::Row& row) {
    const CounterMeaning* const meaning = find_counter(unit, row.name);
    return meaning == nullptr ? Cause::mendable : meaning->cause;
}

/// The rows of one cause: how many inputs they rejected, and the most frequent row.
struct Share {
    std::uint64_t rejected = 0;
    const CounterTable::Row* most = nullptr;
};

Share share_of(const CounterTable& table, Cause cause) {
    Share share;
    for (const CounterTable::Row& row : table.rejected) {
        if (row.count == 0 || cause_of(table.unit, row) != cause) continue;
        share.rejected += row.count;
        if (share.most == nullptr || row.count > share.most->count) share.most = &row;
    }
    return share;
}

std::optional<Loss> most_of(const CounterTable& table, Cause cause, std::uint64_t of) {
    const Share share = share_of(table, cause);
    if (2 * share.rejected <= of) return std::nullopt;
    return Loss{table.title(),    table.unit,        share.rejected,   of, cause == Cause::mendable,
                share.most->name, share.most->count, share.most->first};
}

}  // namespace

std::string remedy_sentence(std::string_view unit, std::string_view name) {
    const CounterMeaning* const meaning = find_counter(unit, name);
    if (meaning == nullptr || meaning->remedy.empty()) return {};
    std::string text = fmt::format(" {}.", meaning->remedy);
    text[1] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[1])));
    return text;
}

std::optional<Loss> loss_of(const CounterTable& table) {
    const std::uint64_t could_be_used =
        table.used + table.pending + share_of(table, Cause::mendable).rejected;
    if (auto loss = most_of(table, Cause::mendable, could_be_used)) return loss;
    const std::uint64_t ours = could_be_used + share_of(table, Cause::scene).rejected;
    if (auto loss = most_of(table, Cause::scene, ours)) return loss;
    return most_of(table, Cause::other_device, table.in);
}

std::optional<Loss> most_frequent(const CounterTable& table) {
    const auto most = std::ranges::max_element(table.rejected, {}, &CounterTable::Row::count);
    if (most == table.rejected.end() || most->count == 0) return std::nullopt;
    std::uint64_t rejected = 0;
    for (const CounterTable::Row& row : table.rejected) rejected += row.count;
    return Loss{
        table.title(), table.unit,  rejected,   table.in, cause_of(table.unit, *most) == Cause::mendable,
        most->name,    most->count, most->first};
}

std::string describe(const Loss& loss) {
    const CounterMeaning* const meaning = find_counter(loss.unit, loss.reason);
    const std::string at = loss.first.empty() ? "" : ", the first at " + loss.first;
    std::string text =
        fmt::format("{}: {} of {} are {}, most as {} ({}{})", loss.title, loss.rejected, loss.of,
                    loss.is_mendable ? "lost" : "not used", loss.reason, loss.count, at);
    if (meaning == nullptr) return text;
    return fmt::format("{}: {}.{}", text, meaning->text, remedy_sentence(loss.unit, loss.reason));
}

}  // namespace octoskin
