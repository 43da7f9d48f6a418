#include "host/io/openni2/camera_mode.hpp"

#include <charconv>
#include <cmath>
#include <sstream>
#include <system_error>

namespace octoskin::openni2 {
namespace {

/// The number at the beginning of `text`, which is removed together with `behind`, the text after it.
template <class Number>
bool take_number(std::string_view& text, std::string_view behind, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{}) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.starts_with(behind)) return false;
    text.remove_prefix(behind.size());
    return true;
}

}  // namespace

std::string to_text(const CameraMode& mode) {
    std::ostringstream text;
    text << mode.width << 'x' << mode.height << '@' << mode.rate_hz;
    return text.str();
}

std::optional<CameraMode> parse_camera_mode(std::string_view text) {
    CameraMode mode;
    const bool is_mode = take_number(text, "x", mode.width) && take_number(text, "@", mode.height) &&
                         take_number(text, "", mode.rate_hz) && text.empty();
    if (!is_mode || !std::isfinite(mode.rate_hz)) return std::nullopt;
    return mode;
}

}  // namespace octoskin::openni2
