// Joint configurations as text: on the command line, in a file of a path, in a datagram.
#pragma once

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// Plain decimal numbers, between each two of them blanks, or one comma and blanks. The error is the field
/// that is no finite number: empty where there is none between two commas, before the first or after the
/// last. Any bytes are safe; nothing but blanks has no number.
[[nodiscard]] Result<std::vector<double>, std::string> read_numbers(std::string_view text);

/// What is wrong with the field that read_numbers() gives back and what is expected, for a person.
[[nodiscard]] std::string describe_field(std::string_view field);

struct JointPath {
    std::vector<std::vector<double>> configurations;
    std::vector<std::size_t> lines;  ///< of each, from 1 on
};

/// What a file of a path may have, all comments counted: some 1 kB for each of kConfigurationsMax.
inline constexpr std::size_t kPathBytesMax = 1 << 20;

/// A configuration a line; empty lines and those that begin with # are none. Reads a block
/// more than kPathBytesMax at the most. Errors name `name`, the line and what it has: bad_data; io_failed if
/// `stream` cannot be read.
[[nodiscard]] Result<JointPath, AppError> read_joint_path(std::istream& stream, const std::string& name);

}  // namespace octoskin
