// The keys of `octoskin monitor`, and which lines it shows if the terminal has too few rows.
#pragma once

#include <cstddef>
#include <string_view>

namespace octoskin {

class Scroll {
  public:
    /// Handles typed bytes as a terminal sends them: arrows or j and k by a line, Page keys or space and b by
    /// a page, Home or g to the top, End or G to the bottom; q ends. Other bytes are ignored. Of `lines`
    /// lines of text, `rows` are shown at once.
    void type(std::string_view keys, std::size_t lines, std::size_t rows);

    /// The first line that is shown; within `lines`, which may have become fewer.
    [[nodiscard]] std::size_t first(std::size_t lines, std::size_t rows) const noexcept;
    [[nodiscard]] bool is_ended() const noexcept { return is_ended_; }

  private:
    std::size_t first_ = 0;
    bool is_ended_ = false;
};

}  // namespace octoskin
