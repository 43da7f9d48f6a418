// Text in HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace octoskin {

/// Safe inside HTML and SVG, as text and as a quoted attribute; bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace octoskin
