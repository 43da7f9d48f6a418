#include "host/apps/monitor/scroll.hpp"

#include <algorithm>
#include <array>

namespace octoskin {
namespace {

enum class Move { line_down, line_up, page_down, page_up, top, bottom, end };
struct Key {
    std::string_view sent;
    Move move;
};
/// Arrows as xterm sends them in its normal and in its application mode.
constexpr std::array<Key, 20> kKeys{{{"\x1b[B", Move::line_down},
                                     {"\x1bOB", Move::line_down},
                                     {"j", Move::line_down},
                                     {"\r", Move::line_down},
                                     {"\n", Move::line_down},
                                     {"\x1b[A", Move::line_up},
                                     {"\x1bOA", Move::line_up},
                                     {"k", Move::line_up},
                                     {"\x1b[6~", Move::page_down},
                                     {" ", Move::page_down},
                                     {"\x1b[5~", Move::page_up},
                                     {"b", Move::page_up},
                                     {"\x1b[H", Move::top},
                                     {"\x1b[1~", Move::top},
                                     {"g", Move::top},
                                     {"\x1b[F", Move::bottom},
                                     {"\x1b[4~", Move::bottom},
                                     {"G", Move::bottom},
                                     {"q", Move::end},
                                     {"Q", Move::end}}};

std::size_t last_first(std::size_t lines, std::size_t rows) {
    return lines > rows ? lines - rows : 0;
}

std::size_t moved(std::size_t first, Move move, std::size_t lines, std::size_t rows) {
    const std::size_t page = std::max<std::size_t>(rows, 2) - 1;  // a line of the page before stays visible
    switch (move) {
        case Move::line_down:
            return first + 1;
        case Move::line_up:
            return first - std::min<std::size_t>(first, 1);
        case Move::page_down:
            return first + page;
        case Move::page_up:
            return first - std::min(first, page);
        case Move::top:
            return 0;
        case Move::bottom:
            return last_first(lines, rows);
        case Move::end:
            break;
    }
    return first;
}

}  // namespace

void Scroll::type(std::string_view keys, std::size_t lines, std::size_t rows) {
    while (!keys.empty()) {  // each round takes at least a byte
        const auto key = std::ranges::find_if(kKeys, [&](const Key& k) { return keys.starts_with(k.sent); });
        keys.remove_prefix(key == kKeys.end() ? 1 : key->sent.size());
        if (key == kKeys.end()) continue;
        is_ended_ |= key->move == Move::end;
        first_ = moved(first(lines, rows), key->move, lines, rows);
        first_ = first(lines, rows);
    }
}

std::size_t Scroll::first(std::size_t lines, std::size_t rows) const noexcept {
    return std::min(first_, last_first(lines, rows));
}

}  // namespace octoskin
