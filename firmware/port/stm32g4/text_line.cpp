#include "firmware/port/stm32g4/text_line.hpp"

namespace octoskin::stm32g4 {

void TextLine::add(char character) noexcept {
    if (length_ < characters_.size()) characters_[length_++] = character;
}

TextLine& TextLine::text(std::string_view words) noexcept {
    for (const char character : words) add(character);
    return *this;
}

TextLine& TextLine::number(std::uint32_t value) noexcept {
    std::uint32_t unit = 1;
    while (value / unit >= 10) unit *= 10;
    for (; unit > 0; unit /= 10) add(static_cast<char>('0' + value / unit % 10));
    return *this;
}

TextLine& TextLine::hex(std::uint32_t value, unsigned digits) noexcept {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    for (unsigned i = digits; i > 0; --i) add(kDigits[(value >> (4 * (i - 1))) & 0xFU]);
    return *this;
}

}  // namespace octoskin::stm32g4
