// Numbers in the attributes of a URDF.
#pragma once

#include <tinyxml2.h>

#include <Eigen/Core>
#include <cmath>
#include <locale>
#include <optional>
#include <sstream>

namespace octoskin::rig {

/// Empty unless the attribute has exactly `Count` finite numbers, with blanks between them.
template <int Count>
std::optional<Eigen::Matrix<double, Count, 1>> numbers_of(const tinyxml2::XMLElement& element,
                                                          const char* name) {
    const char* const text = element.Attribute(name);
    std::istringstream stream(text == nullptr ? "" : text);
    stream.imbue(std::locale::classic());
    Eigen::Matrix<double, Count, 1> numbers;
    for (int i = 0; i < Count; ++i)
        if (!(stream >> numbers[i]) || !std::isfinite(numbers[i])) return std::nullopt;
    stream >> std::ws;
    return stream.eof() ? std::optional(numbers) : std::nullopt;
}

}  // namespace octoskin::rig
