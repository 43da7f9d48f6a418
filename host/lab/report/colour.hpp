// Colours of the report's pictures: linear light, and a palette for the common forms of colour blindness
// (after Okabe and Ito 2008: blue, yellow and vermilion differ in lightness as well as in hue).
#pragma once

#include <cmath>
#include <cstdint>

namespace octoskin::report {

/// Linear light, 0..1 each.
struct Colour {
    float red = 0.0F;
    float green = 0.0F;
    float blue = 0.0F;

    friend constexpr Colour operator+(Colour a, Colour b) noexcept {
        return {a.red + b.red, a.green + b.green, a.blue + b.blue};
    }
    friend constexpr Colour operator*(float factor, Colour colour) noexcept {
        return {factor * colour.red, factor * colour.green, factor * colour.blue};
    }
};

/// One channel, IEC 61966-2-1.
[[nodiscard]] inline float linear_of_srgb(std::uint8_t value) noexcept {
    const float share = static_cast<float>(value) / 255.0F;
    return share <= 0.04045F ? share / 12.92F : std::pow((share + 0.055F) / 1.055F, 2.4F);
}

/// Values above 1 are clamped.
[[nodiscard]] inline std::uint8_t srgb_of_linear(float linear) noexcept {
    const float light = linear < 0.0F ? 0.0F : linear > 1.0F ? 1.0F : linear;
    const float share = light <= 0.0031308F ? 12.92F * light : 1.055F * std::pow(light, 1.0F / 2.4F) - 0.055F;
    return static_cast<std::uint8_t>(std::lround(255.0F * share));
}

/// From 0xRRGGBB as a style sheet writes it.
[[nodiscard]] inline Colour colour_of(std::uint32_t rgb) noexcept {
    return {linear_of_srgb(static_cast<std::uint8_t>(rgb >> 16U)),
            linear_of_srgb(static_cast<std::uint8_t>(rgb >> 8U)),
            linear_of_srgb(static_cast<std::uint8_t>(rgb))};
}

namespace palette {
inline constexpr std::uint32_t kRight = 0x5b9bd5;
inline constexpr std::uint32_t kHiddenObject = 0xf2c230;
inline constexpr std::uint32_t kWrong = 0xd1481f;
inline constexpr std::uint32_t kLost = 0x9a6fb8;
inline constexpr std::uint32_t kFloor = 0xb9c0ca;
inline constexpr std::uint32_t kFurniture = 0xd9cbb5;
inline constexpr std::uint32_t kRobot = 0xbcc5d0;
inline constexpr std::uint32_t kCamera = 0x2f6f8f;
inline constexpr std::uint32_t kBeam = 0xd1481f;
}  // namespace palette

}  // namespace octoskin::report
