// Which lines of more than a terminal holds `octoskin monitor` shows: its keys.
#pragma once

#include <cstddef>
#include <string_view>

namespace octoskin {

class Scroll {
  public:
    /// What was typed, as a terminal sends it: arrows or j and k by a line, Page keys or space and b by a
    /// page, Home or g to the top, End or G to the bottom; q ends. Anything else is nothing. `lines` of text,
    /// `rows` of which are shown at once.
    void type(std::string_view keys, std::size_t lines, std::size_t rows);

    /// The first line that is shown; within `lines`, which may have become fewer.
    [[nodiscard]] std::size_t first(std::size_t lines, std::size_t rows) const noexcept;
    [[nodiscard]] bool is_ended() const noexcept { return is_ended_; }

  private:
    std::size_t first_ = 0;
    bool is_ended_ = false;
};

}  // namespace octoskin
