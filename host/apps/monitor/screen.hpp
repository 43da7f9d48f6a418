// What `octoskin monitor` shows: two answers of the daemon, some time apart, as lines of text.
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

/// `before` and `now`: status objects (docs/daemon.md), the first `passed` earlier: rates are what grew
/// between them. Problems come first, then a line for each input and the map, so that they are seen on the
/// smallest terminal; sensors and counters follow. A status of another version may lack keys: what is not
/// there is not shown.
[[nodiscard]] std::vector<ScreenLine> screen_of(const nlohmann::ordered_json& before,
                                                const nlohmann::ordered_json& now,
                                                std::chrono::duration<double> passed);

/// Lines that are longer than so many columns go on in the next ones, indented, broken between words.
[[nodiscard]] std::vector<ScreenLine> wrapped(const std::vector<ScreenLine>& lines, std::size_t columns);

/// How many of so many lines fit: where they do not all, the last row says so.
[[nodiscard]] std::size_t rows_for(std::size_t lines, ScreenSize size) noexcept;

/// Cut to the terminal, from line `first` on (of 0, with which those that fit are shown): what does not fit
/// is said in the last row. With colours as ANSI sequences, if wanted.
[[nodiscard]] std::string to_terminal(const std::vector<ScreenLine>& lines, ScreenSize size, bool has_colours,
                                      std::size_t first = 0);

}  // namespace octoskin
