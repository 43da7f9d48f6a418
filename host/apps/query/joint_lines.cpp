#include "host/apps/query/joint_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "host/apps/query/query_request.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

std::string_view without_blanks_before(std::string_view text) {
    return text.substr(std::min(text.find_first_not_of(kBlank), text.size()));
}

/// Empty if the word is not a finite number.
std::optional<double> number_of(std::string_view word) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    const bool is_whole = error == std::errc{} && end == word.data() + word.size();
    return is_whole && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

Result<std::string, AppError> read_bounded(std::istream& stream, const std::string& name) {
    std::string text;
    std::array<char, 4096> block{};
    while (stream && text.size() <= kPathBytesMax) {
        stream.read(block.data(), block.size());
        text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
    }
    if (stream.bad())
        return fail(ExitCode::io_failed, in_file({ErrorCode::system_error, "cannot be read"}, name));
    if (text.size() <= kPathBytesMax) return text;
    return fail(
        ExitCode::bad_data,
        in_file({.code = ErrorCode::too_large,
                 .what = fmt::format("expected a path of at most {} bytes", kPathBytesMax),
                 .remedy = fmt::format("give one configuration a line, at most {}", kConfigurationsMax)},
                name));
}

}  // namespace

Result<std::vector<double>, std::string> read_numbers(std::string_view text) {
    std::vector<double> numbers;
    bool is_after_comma = false;
    for (text = without_blanks_before(text);
         !text.empty() || is_after_comma;) {  // each iteration removes one word
        const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n,"));
        const auto number = number_of(word);
        if (!number) return unexpected(std::string(word));
        numbers.push_back(*number);
        text = without_blanks_before(text.substr(word.size()));
        is_after_comma = text.starts_with(',');
        if (is_after_comma) text = without_blanks_before(text.substr(1));
    }
    return numbers;
}

Error field_error(std::string_view field) {
    constexpr std::size_t kShown = 40;
    std::string shown(field.substr(0, kShown));
    for (char& c : shown)
        if (c < ' ' || c > '~') c = '?';
    return {.code = ErrorCode::bad_syntax,
            .what =
                "expected a joint configuration: one plain, finite number for each joint of the rig, with "
                "commas between them",
            .value = field.empty() ? std::string("no number beside a comma")
                                   : fmt::format("'{}{}'", shown, field.size() > kShown ? "..." : ""),
            .remedy = "write it such as 0,-0.785,1.5"};
}

Result<JointPath, AppError> read_joint_path(std::istream& stream, const std::string& name) {
    auto text = read_bounded(stream, name);
    if (!text) return unexpected(text.error());
    std::istringstream lines(std::move(*text));
    JointPath path;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.starts_with('#') || without_blanks_before(line).empty()) continue;
        auto configuration = read_numbers(line);
        if (!configuration)
            return fail(ExitCode::bad_data,
                        in_file(field_error(configuration.error()), name, static_cast<int>(number)));
        if (path.lines.size() >= kConfigurationsMax)
            return fail(
                ExitCode::bad_data,
                in_file({.code = ErrorCode::limit_exceeded,
                         .what = fmt::format("expected at most {} configurations", kConfigurationsMax),
                         .value = "one more",
                         .remedy = "query parts of the path"},
                        name, static_cast<int>(number)));
        path.configurations.push_back(std::move(*configuration));
        path.lines.push_back(number);
    }
    if (path.lines.empty())
        return fail(ExitCode::bad_data,
                    in_file({ErrorCode::no_content, "no joint configuration in it"}, name));
    return path;
}

}  // namespace octoskin
