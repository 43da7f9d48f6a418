// Joint configurations as text: on the command line, in a path file, in a datagram.
#pragma once

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// Plain decimal numbers, separated by blanks, or by one comma with optional blanks. The error is the field
/// that is not a finite number; it is empty where a number is missing between two commas, before the first or
/// after the last. Any bytes are safe as input. A text of blanks gives no numbers.
[[nodiscard]] Result<std::vector<double>, std::string> read_numbers(std::string_view text);

/// The error for the field from read_numbers(), with the expected form.
[[nodiscard]] Error field_error(std::string_view field);

struct JointPath {
    std::vector<std::vector<double>> configurations;
    std::vector<std::size_t> lines;  ///< line number of each configuration, from 1
};

/// Size limit of a path file, comments included: about 1 kB for each of kConfigurationsMax.
inline constexpr std::size_t kPathBytesMax = 1 << 20;

/// One configuration a line; empty lines and lines that begin with # are skipped. Reads at most one block
/// more than kPathBytesMax. Errors contain `name` as the file, the line and its content: bad_data; io_failed
/// if `stream` cannot be read.
[[nodiscard]] Result<JointPath, AppError> read_joint_path(std::istream& stream, const std::string& name);

}  // namespace octoskin
