// The screen of `octoskin monitor`: two answers of the daemon, some time apart, as lines of text.
#pragma once

#include <chrono>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace octoskin {

struct ScreenSize {
    std::size_t columns = 80;
    std::size_t rows = 24;
};

enum class Emphasis : std::uint8_t { none, title, good, bad };
struct ScreenLine {
    std::string text;
    Emphasis emphasis = Emphasis::none;
};

/// `before` and `now`: status objects (docs/status.md), the first `passed` earlier: rates are what grew
/// between them. Problems come first, then a line for each input and the map, so that they are seen on the
/// smallest terminal; sensors and counters follow. A status of another version may lack keys: what is not
/// there is not shown.
[[nodiscard]] std::vector<ScreenLine> screen_of(const nlohmann::ordered_json& before,
                                                const nlohmann::ordered_json& now,
                                                std::chrono::duration<double> passed);

/// Lines longer than `columns` continue in the next line, indented, broken between words.
[[nodiscard]] std::vector<ScreenLine> wrapped(const std::vector<ScreenLine>& lines, std::size_t columns);

/// How many of `lines` fit: if not all do, the last row of the terminal states it.
[[nodiscard]] std::size_t rows_for(std::size_t lines, ScreenSize size) noexcept;

/// Cut to the terminal, from line `first` on (0-based; the lines that fit are shown). If lines are left over,
/// the last row states which are shown. With colours as ANSI sequences, if wanted.
[[nodiscard]] std::string to_terminal(const std::vector<ScreenLine>& lines, ScreenSize size, bool has_colours,
                                      std::size_t first = 0);

}  // namespace octoskin
