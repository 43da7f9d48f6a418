#include "host/io/tum/data_set_lines.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

namespace octoskin::tum {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::int64_t kSecondsMax = 9'000'000'000;  // so that nanoseconds fit in 63 bits
constexpr double kPositionMax = 1e6;
constexpr double kTolerance = 0.01;  // of a quaternion's length, and of a rotation's numbers

/// Removes the first word and returns it; empty if there is none.
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

std::string_view without_plus(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
    return word;
}

/// A decimal number: digits, and the position of its point.
struct Decimal {
    std::string digits;  ///< without leading zeros
    std::int64_t point = 0;
};

/// "1305031102.16", "1.30503110216e+09", ".5", "7."; no sign except a plus.
std::optional<Decimal> parse_decimal(std::string_view word) {
    constexpr int kExponentMax = 1000;
    word = without_plus(word);
    const std::size_t e = std::min(word.find_first_of("eE"), word.size());
    int exponent = 0;
    if (e < word.size()) {
        const std::string_view power = without_plus(word.substr(e + 1));
        const auto [end, error] = std::from_chars(power.data(), power.data() + power.size(), exponent);
        if (error != std::errc{} || end != power.data() + power.size() || std::abs(exponent) > kExponentMax)
            return std::nullopt;
    }
    const std::string_view mantissa = word.substr(0, e);
    const std::size_t dot = std::min(mantissa.find('.'), mantissa.size());
    Decimal decimal{std::string(mantissa.substr(0, dot)), 0};
    if (dot < mantissa.size()) decimal.digits += mantissa.substr(dot + 1);
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    if (decimal.digits.empty() || !std::ranges::all_of(decimal.digits, is_digit)) return std::nullopt;
    const std::size_t zeros = std::min(decimal.digits.find_first_not_of('0'), decimal.digits.size());
    decimal.digits.erase(0, zeros);
    decimal.point = static_cast<std::int64_t>(dot) + exponent - static_cast<std::int64_t>(zeros);
    return decimal;
}

/// Exact; a double would not be: at present-day seconds its resolution is 0.2 us.
std::optional<HostTime> parse_time(std::string_view word) {
    constexpr std::int64_t kPlacesMax = 10;  // of kSecondsMax
    constexpr std::int64_t kDecimals = 9;
    const auto decimal = parse_decimal(word);
    if (!decimal) return std::nullopt;
    const std::int64_t point = decimal->digits.empty() ? 0 : decimal->point;
    if (point > kPlacesMax) return std::nullopt;
    const auto append = [&digits = decimal->digits](std::int64_t number, std::int64_t place) {
        const bool is_there = place >= 0 && place < static_cast<std::int64_t>(digits.size());
        return 10 * number + (is_there ? digits[static_cast<std::size_t>(place)] - '0' : 0);
    };
    std::int64_t seconds = 0;
    for (std::int64_t place = 0; place < point; ++place) seconds = append(seconds, place);
    std::int64_t ns = 0;
    for (std::int64_t place = point; place < point + kDecimals; ++place) ns = append(ns, place);
    if (seconds > kSecondsMax) return std::nullopt;
    return HostTime{1'000'000'000 * seconds + ns};
}

std::optional<double> parse_number(std::string_view word) {
    word = without_plus(word);
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || word.empty()) return std::nullopt;
    const bool is_tiny = error == std::errc::result_out_of_range &&
                         word.find("e-") + word.find("E-") != 2 * std::string_view::npos;
    if (is_tiny) return 0.0;
    return error == std::errc{} ? std::optional(value) : std::nullopt;
}

Unexpected<std::string> refuse_time(std::string_view word) {
    return unexpected("expected a time in seconds, found '" + std::string(word.substr(0, 40)) + "'");
}

bool says_depth(std::string_view file) {
    constexpr std::string_view kDepth = "depth";
    const auto is_same = [](char a, char b) { return (a | 0x20) == b; };
    return std::search(file.begin(), file.end(), kDepth.begin(), kDepth.end(), is_same) != file.end();
}

Result<ImageLine, std::string> take_image(std::string_view& line) {
    const std::string_view time = take_word(line);
    const auto captured = parse_time(time);
    if (!captured) return refuse_time(time);
    const std::string_view file = take_word(line);
    if (file.empty()) return unexpected(std::string("expected the name of an image after the time"));
    return ImageLine{*captured, std::string(file)};
}

}  // namespace

Result<ImageLine, std::string> parse_image_line(std::string_view line) {
    auto image = take_image(line);
    if (!image || is_blank(line)) return image;
    auto other = take_image(line);
    if (!other || !is_blank(line))
        return unexpected(std::string("expected only a time and the name of an image, found more"));
    const bool is_depth = says_depth(image->file);
    if (is_depth == says_depth(other->file)) {
        return unexpected("expected one depth image, with \"depth\" in its name or its folder's, found '" +
                          image->file + "' and '" + other->file + "'");
    }
    return is_depth ? image : other;
}

Result<PoseLine, std::string> parse_pose_line(std::string_view line) {
    const std::string_view time = take_word(line);
    const auto at = parse_time(time);
    if (!at) return refuse_time(time);
    std::array<double, 7> values{};
    bool is_known = true;
    for (double& value : values) {
        const std::string_view word = take_word(line);
        const auto number = parse_number(word);
        if (!number || (std::isfinite(*number) && std::abs(*number) > kPositionMax)) {
            return unexpected("expected tx ty tz qx qy qz qw after the time, found '" +
                              std::string(word.substr(0, 40)) + "' in place of a number");
        }
        is_known &= std::isfinite(*number);
        value = *number;
    }
    if (!is_blank(line)) return unexpected(std::string("expected only a time and seven numbers, found more"));
    const Eigen::Quaterniond q_map_camera(values[6], values[3], values[4], values[5]);
    if (!is_known || q_map_camera.coeffs().isZero(0.0)) return PoseLine{*at, std::nullopt};
    if (std::abs(q_map_camera.norm() - 1.0) > kTolerance) {
        return unexpected("the quaternion's length is " + std::to_string(q_map_camera.norm()) +
                          ", expected 1");
    }
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    T_map_camera.linear() = q_map_camera.normalized().toRotationMatrix();
    T_map_camera.translation() = Eigen::Vector3d(values[0], values[1], values[2]);
    return PoseLine{*at, T_map_camera};
}

Result<std::vector<double>, std::string> parse_numbers(std::string_view text, std::size_t count_max) {
    std::vector<double> numbers;
    while (!is_blank(text)) {  // each iteration removes a word
        const std::string_view word = take_word(text);
        const auto number = parse_number(word);
        if (!number) return unexpected("expected a number, found '" + std::string(word.substr(0, 40)) + "'");
        if (numbers.size() == count_max)
            return unexpected("expected " + std::to_string(count_max) + " numbers, found more");
        numbers.push_back(*number);
    }
    return numbers;
}

Result<std::optional<Eigen::Isometry3d>, std::string> parse_pose_matrix(std::string_view text) {
    constexpr std::size_t kNumbers = 16;
    const auto numbers = parse_numbers(text, kNumbers);
    if (!numbers) return unexpected(numbers.error());
    if (numbers->size() != kNumbers) {
        return unexpected("expected the 16 numbers of a 4 x 4 matrix, found " +
                          std::to_string(numbers->size()));
    }
    const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers->data());
    if (!T.allFinite() || T.topLeftCorner<3, 3>().isZero(0.0)) return std::optional<Eigen::Isometry3d>{};
    const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
    if ((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kTolerance ||
        R.determinant() < 0.0) {
        return unexpected(std::string("its upper left 3 x 3 numbers are not a rotation"));
    }
    if (T.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        return unexpected(std::string("its last row is not 0 0 0 1"));
    if (T.topRightCorner<3, 1>().cwiseAbs().maxCoeff() > kPositionMax)
        return unexpected(std::string("its position is over 1000 km away"));
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    T_map_camera.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
    T_map_camera.translation() = T.topRightCorner<3, 1>();
    return std::optional(T_map_camera);
}

}  // namespace octoskin::tum
