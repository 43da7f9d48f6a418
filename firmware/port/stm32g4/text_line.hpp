// Composes one line of text in a fixed buffer; excess text is cut off. Firmware has no printf.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace octoskin::stm32g4 {

class TextLine {
  public:
    TextLine& text(std::string_view words) noexcept;
    TextLine& number(std::uint32_t value) noexcept;
    /// Upper case, exactly `digits` (1..8) digits.
    TextLine& hex(std::uint32_t value, unsigned digits) noexcept;

    [[nodiscard]] std::string_view view() const noexcept { return {characters_.data(), length_}; }

  private:
    void add(char character) noexcept;

    std::array<char, 100> characters_{};
    std::size_t length_ = 0;
};

}  // namespace octoskin::stm32g4
