#include "host/io/orderlog/order_line.hpp"

#include <fmt/format.h>

#include <cassert>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>

#include "host/core/kinematics/joint_twist.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin::orderlog {
namespace {

constexpr std::string_view kSchema = "octoskin-order/2";
constexpr std::string_view kSchemaBefore = "octoskin-order/1";  ///< begins with first.ot only
constexpr std::string_view kNone = "-";

/// Takes words from a line, separated by one blank; is_sound stays false after the first word that is not as
/// requested.
class Words {
  public:
    explicit Words(std::string_view line) : rest_(line) {}

    void expect(std::string_view word) { is_sound_ = next() == word && is_sound_; }
    template <class Number>
    Number number(Number max = std::numeric_limits<Number>::max()) {
        return to_number(next(), max);
    }
    template <class Number>
    std::optional<Number> optional_number() {
        const std::string_view word = next();
        if (word == kNone) return std::nullopt;
        return to_number(word, std::numeric_limits<Number>::max());
    }
    std::optional<std::uint32_t> optional_crc() {
        const std::string_view word = next();
        if (word == kNone) return std::nullopt;
        return to_crc(word);
    }
    std::uint32_t crc() { return to_crc(next()); }
    /// Takes the next word if it is this one.
    bool take(std::string_view word) {
        const bool is_next =
            !is_over_ && rest_.starts_with(word) && rest_.substr(word.size()).starts_with(' ');
        if (is_next) (void)next();
        return is_next;
    }
    /// "7+2": the joints of each source.
    std::vector<std::size_t> joint_counts() {
        std::vector<std::size_t> counts;
        std::size_t sum = 0;
        for (std::string_view rest = next(); is_sound_;) {
            const std::size_t end = rest.find('+');
            counts.push_back(to_number<std::size_t>(rest.substr(0, end), wire::kJointsPerSample));
            sum += counts.back();
            is_sound_ = is_sound_ && counts.back() > 0 && sum <= kJointsMax;
            if (end == std::string_view::npos) break;
            rest = rest.substr(end + 1);
        }
        return counts;
    }
    /// All words were as requested, and none is left.
    [[nodiscard]] bool is_sound() const { return is_sound_ && is_over_; }

  private:
    std::string_view next() {
        if (is_over_) is_sound_ = false;
        const std::size_t end = rest_.find(' ');
        const std::string_view word = rest_.substr(0, end);
        is_over_ = end == std::string_view::npos;
        rest_ = is_over_ ? std::string_view{} : rest_.substr(end + 1);
        return word;
    }
    template <class Number>
    Number to_number(std::string_view word, Number max) {
        Number value{};
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        is_sound_ = is_sound_ && error == std::errc{} && end == word.data() + word.size();
        if constexpr (std::is_floating_point_v<Number>) {
            is_sound_ = is_sound_ && std::isfinite(value);
        } else {
            is_sound_ = is_sound_ && value >= 0 && value <= max;
        }
        return value;
    }
    std::uint32_t to_crc(std::string_view word) {
        constexpr int kHex = 16;
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, kHex);
        is_sound_ = is_sound_ && error == std::errc{} && end == word.data() + word.size() && word.size() == 8;
        return value;
    }

    std::string_view rest_;
    bool is_over_ = false;
    bool is_sound_ = true;
};

/// The latest time of a clock in nanoseconds whose sums cannot overflow: 146 years.
constexpr std::int64_t kTimeMax = std::numeric_limits<std::int64_t>::max() / 2;
constexpr std::int64_t kWaitMax = kTimeMax / 1'000'000'000;

std::string crc_or_none(const std::optional<std::uint32_t>& crc) {
    return crc ? fmt::format("{:08x}", *crc) : std::string(kNone);
}

std::string format(const JointMeasurement& joints, std::span<const std::size_t> counts) {
    assert(joints.source < counts.size() && counts[joints.source] <= joints.position_rad.size());
    std::string line = counts.size() > 1 ? fmt::format("J {} {}", joints.source, joints.sampled.ns)
                                         : fmt::format("J {}", joints.sampled.ns);
    for (std::size_t i = 0; i < counts[joints.source]; ++i) {
        fmt::format_to(std::back_inserter(line), " {}", joints.position_rad[i]);
    }
    return line + '\n';
}

std::string format(const RangeMeasurement& reading) {
    const auto& [node, sensor, zone] = reading.source;
    const std::string range = reading.range_m ? fmt::format("{}", *reading.range_m) : std::string(kNone);
    return fmt::format("R {} {} {} {} {} {}\n", node, sensor, zone, reading.captured.ns, range,
                       reading.sigma_m);
}

std::string format(const DepthCommit& frame, std::size_t cameras) {
    assert(frame.camera < cameras);
    const std::string index = frame.index ? fmt::format("{}", *frame.index) : std::string(kNone);
    if (cameras == 1) return fmt::format("D {} {}\n", index, frame.captured.ns);
    return fmt::format("D {} {} {}\n", frame.camera, index, frame.captured.ns);
}

JointMeasurement parse_joints(Words& words, std::span<const std::size_t> counts) {
    JointMeasurement joints;
    if (counts.size() > 1) joints.source = words.number(static_cast<std::uint8_t>(counts.size() - 1));
    joints.sampled = {words.number(kTimeMax)};
    if (joints.source >= counts.size()) return joints;  // not sound
    for (std::size_t i = 0; i < counts[joints.source]; ++i) joints.position_rad[i] = words.number<double>();
    return joints;
}

RangeMeasurement parse_reading(Words& words) {
    RangeMeasurement reading;
    reading.source.node_id = words.number<std::uint8_t>();
    reading.source.sensor = words.number<std::uint8_t>();
    reading.source.zone = words.number<std::uint8_t>();
    reading.captured.ns = words.number(kTimeMax);
    reading.range_m = words.optional_number<double>();
    reading.sigma_m = words.number<double>();
    return reading;
}

std::string format(const WaitCommit& passed) {
    return fmt::format("W {}\n", passed.seconds);
}

DepthCommit parse_depth(Words& words, std::size_t cameras) {
    DepthCommit frame;
    if (cameras > 1) frame.camera = words.number(static_cast<std::uint8_t>(cameras - 1));
    frame.index = words.optional_number<std::uint64_t>();
    frame.captured = {words.number(kTimeMax)};
    return frame;
}

}  // namespace

std::string joints_text(std::span<const std::size_t> joints) {
    std::string text;
    for (const std::size_t count : joints) {
        if (!text.empty()) text += '+';
        text += std::to_string(count);
    }
    return text;
}

std::string format_header(const Header& header) {
    const auto& state = header.first_state;
    const std::size_t cameras = header.form.cameras;
    return fmt::format("{} rig {:08x} mapping {:08x} joints {}{} first {}{}\n",
                       state ? kSchema : kSchemaBefore, header.rig_hash, header.mapping_crc32,
                       joints_text(header.form.joints),
                       cameras > 1 ? fmt::format(" cameras {}", cameras) : "", crc_or_none(header.first_map),
                       state ? fmt::format(" state {:08x}", *state) : "");
}

std::string format_commit(const Commit& commit, const CommitForm& form) {
    if (const auto* const sample = std::get_if<JointMeasurement>(&commit))
        return format(*sample, form.joints);
    if (const auto* const reading = std::get_if<RangeMeasurement>(&commit)) return format(*reading);
    if (const auto* const passed = std::get_if<WaitCommit>(&commit)) return format(*passed);
    return format(std::get<DepthCommit>(commit), form.cameras);
}

std::string format_trailer(const Trailer& trailer) {
    return fmt::format("end commits {} lost_can {} lost_commits {} lost_depth {} last {}\n", trailer.commits,
                       trailer.lost_can, trailer.lost_commits, trailer.lost_depth,
                       crc_or_none(trailer.last_map));
}

std::optional<Header> parse_header(std::string_view line) {
    Words words(line);
    Header header;
    const bool is_of_before = line.starts_with(kSchemaBefore);
    words.expect(is_of_before ? kSchemaBefore : kSchema);
    words.expect("rig");
    header.rig_hash = words.crc();
    words.expect("mapping");
    header.mapping_crc32 = words.crc();
    words.expect("joints");
    header.form.joints = words.joint_counts();
    if (words.take("cameras")) header.form.cameras = words.number(kCamerasMax);
    words.expect("first");
    header.first_map = words.optional_crc();
    if (!is_of_before) {
        words.expect("state");
        header.first_state = words.crc();
    }
    if (!words.is_sound() || header.form.cameras == 0) return std::nullopt;
    return header;
}

std::optional<Commit> parse_commit(std::string_view line, const CommitForm& form) {
    if (line.size() < 2 || line[1] != ' ') return std::nullopt;
    Words words(line.substr(2));
    std::optional<Commit> commit;
    if (line[0] == 'J') commit = parse_joints(words, form.joints);
    if (line[0] == 'R') commit = parse_reading(words);
    if (line[0] == 'D') commit = parse_depth(words, form.cameras);
    if (line[0] == 'W') commit = WaitCommit{words.number(kWaitMax)};
    return words.is_sound() ? commit : std::nullopt;
}

std::optional<Trailer> parse_trailer(std::string_view line) {
    Words words(line);
    Trailer trailer;
    words.expect("end");
    words.expect("commits");
    trailer.commits = words.number<std::uint64_t>();
    words.expect("lost_can");
    trailer.lost_can = words.number<std::uint64_t>();
    words.expect("lost_commits");
    trailer.lost_commits = words.number<std::uint64_t>();
    words.expect("lost_depth");
    trailer.lost_depth = words.number<std::uint64_t>();
    words.expect("last");
    trailer.last_map = words.optional_crc();
    if (!words.is_sound()) return std::nullopt;
    return trailer;
}

}  // namespace octoskin::orderlog
