#include "host/io/tum/data_set_lines.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

namespace octoskin::tum {
namespace {

constexpr std::string_view kBlanks = " \t";
constexpr std::int64_t kSecondsMax = 9'000'000'000;  // so that nanoseconds fit

/// Cuts the first word off; empty if there is none.
std::string_view take_word(std::string_view& line) {
    const std::size_t begin = std::min(line.find_first_not_of(kBlanks), line.size());
    line.remove_prefix(begin);
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    line.remove_prefix(word.size());
    return word;
}

bool is_blank(std::string_view line) {
    return line.find_first_not_of(kBlanks) == std::string_view::npos;
}

/// Exactly, which a double would not be: seconds of today leave it 0.2 us.
std::optional<HostTime> parse_time(std::string_view word) {
    const std::size_t dot = std::min(word.find('.'), word.size());
    std::int64_t seconds = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + dot, seconds);
    if (error != std::errc{} || end != word.data() + dot || seconds < 0 || seconds > kSecondsMax)
        return std::nullopt;
    std::int64_t ns = 1'000'000'000 * seconds;
    std::int64_t weight = 100'000'000;
    for (std::size_t i = dot + 1; i < word.size(); ++i, weight /= 10) {
        if (word[i] < '0' || word[i] > '9') return std::nullopt;
        ns += weight * (word[i] - '0');
    }
    return HostTime{ns};
}

std::optional<double> parse_number(std::string_view word) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

Unexpected<std::string> refuse_time(std::string_view word) {
    return unexpected("expected a time in seconds, found '" + std::string(word.substr(0, 40)) + "'");
}

}  // namespace

Result<ImageLine, std::string> parse_image_line(std::string_view line) {
    const std::string_view time = take_word(line);
    const auto captured = parse_time(time);
    if (!captured) return refuse_time(time);
    const std::string_view file = take_word(line);
    if (file.empty()) return unexpected(std::string("expected the name of an image behind the time"));
    if (!is_blank(line))
        return unexpected(std::string("expected a time and the name of an image, found more"));
    return ImageLine{*captured, std::string(file)};
}

Result<PoseLine, std::string> parse_pose_line(std::string_view line) {
    constexpr double kPositionMax = 1e6;
    constexpr double kLengthTolerance = 0.01;
    const std::string_view time = take_word(line);
    const auto at = parse_time(time);
    if (!at) return refuse_time(time);
    std::array<double, 7> values{};
    for (double& value : values) {
        const std::string_view word = take_word(line);
        const auto number = parse_number(word);
        if (!number || !(std::abs(*number) <= kPositionMax)) {
            return unexpected("expected tx ty tz qx qy qz qw behind the time, found '" +
                              std::string(word.substr(0, 40)) + "' where a number must be");
        }
        value = *number;
    }
    if (!is_blank(line)) return unexpected(std::string("expected a time and seven numbers, found more"));
    const Eigen::Quaterniond q_map_camera(values[6], values[3], values[4], values[5]);
    if (std::abs(q_map_camera.norm() - 1.0) > kLengthTolerance) {
        return unexpected("the quaternion's length is " + std::to_string(q_map_camera.norm()) +
                          ", expected 1");
    }
    PoseLine pose{*at, Eigen::Isometry3d::Identity()};
    pose.T_map_camera.linear() = q_map_camera.normalized().toRotationMatrix();
    pose.T_map_camera.translation() = Eigen::Vector3d(values[0], values[1], values[2]);
    return pose;
}

}  // namespace octoskin::tum
