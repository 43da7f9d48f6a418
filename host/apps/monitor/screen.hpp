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
/// between them. Problems come first, so that they are seen on the smallest terminal. A status of another
/// version may lack keys: what is not there is not shown.
[[nodiscard]] std::vector<ScreenLine> screen_of(const nlohmann::ordered_json& before,
                                                const nlohmann::ordered_json& now,
                                                std::chrono::duration<double> passed);

/// Cut to the terminal: what does not fit is said in the last line. With colours as ANSI sequences, if
/// wanted.
[[nodiscard]] std::string to_terminal(const std::vector<ScreenLine>& lines, ScreenSize size,
                                      bool has_colours);

}  // namespace octoskin
