#include "host/apps/daemon/joint_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "host/apps/query/joint_lines.hpp"
#include "host/core/ingest/local_joints.hpp"

namespace octoskin {
namespace {

constexpr double kNsPerS = 1e9;
constexpr double kTimeOffMaxS = 1.0;

double seconds_at(HostTime time) {
    return static_cast<double>(time.ns) / kNsPerS;
}
bool is_too_large(double position) {
    return std::abs(position) > LocalJoints::kLargest;
}

/// A line's numbers, without the meaning of any.
struct Words {
    std::optional<double> time_s;
    std::vector<double> numbers;            ///< of a line of numbers, with its time
    std::map<std::string, double> by_name;  ///< of a line of names: those that the rig has
    bool are_named = false;
};

bool has_name(const LineJoints& joints, std::string_view name) {
    return std::ranges::any_of(joints.sources, [name](const LineJoints::Source& source) {
        return std::ranges::find(source.names, name) != source.names.end();
    });
}

/// Splits "NAME=Q" words; the error is the word that is none. Of names that the rig does not have, the
/// position may be anything.
Result<Words, std::string> read_named(std::string_view text, const LineJoints& joints) {
    constexpr std::string_view kBetween = " \t\r\n,";
    Words words;
    while (true) {  // each round removes one word
        text = text.substr(std::min(text.find_first_not_of(kBetween), text.size()));
        if (text.empty()) return words;
        const std::string_view word = text.substr(0, text.find_first_of(kBetween));
        text = text.substr(word.size());
        const std::size_t equals = word.rfind('=');
        const std::string_view name = word.substr(0, std::min(equals, word.size()));
        words.are_named = words.are_named || equals != std::string_view::npos;
        if (equals != std::string_view::npos && !has_name(joints, name)) continue;
        const bool is_time = equals == std::string_view::npos && !words.time_s && !words.are_named;
        const auto number = read_numbers(is_time ? word : word.substr(std::min(equals, word.size() - 1) + 1));
        if (!number || number->size() != 1 || (!is_time && equals == std::string_view::npos))
            return unexpected(std::string(word));
        if (is_time) {
            words.time_s = number->front();
        } else if (!words.by_name.try_emplace(std::string(name), number->front()).second) {
            return unexpected(std::string(word));  // a name twice has no one position
        }
    }
}

Result<Words, std::string> read_words(std::string_view text, const LineJoints& joints) {
    if (text.find('=') != std::string_view::npos) return read_named(text, joints);
    auto numbers = read_numbers(text);
    if (!numbers) return unexpected(numbers.error());
    Words words{.time_s = {}, .numbers = std::move(*numbers), .by_name = {}};
    if (words.numbers.size() == joints.count() + 1) words.time_s = words.numbers.front();
    return words;
}

/// What the line has of a source: all of its joints, some or none.
std::vector<double> position_of(const Words& words, const LineJoints::Source& source) {
    std::vector<double> position;
    for (const std::string& name : source.names)
        if (const auto found = words.by_name.find(name); found != words.by_name.end())
            position.push_back(found->second);
    return position;
}

/// A continuous joint may turn for ever, but the wire has few turns.
void unwind(const LineJoints::Source& source, std::vector<double>& position) {
    for (std::size_t i = 0; i < source.turns.size(); ++i)
        if (source.turns[i]) position[i] = std::remainder(position[i], 2.0 * std::numbers::pi);
}

/// Empty if the line has another number of joints, or a part of a source.
std::vector<JointSample> samples_of(const Words& words, const LineJoints& joints) {
    std::vector<JointSample> samples;
    std::span<const double> rest = words.numbers;
    if (!words.are_named) {
        if (rest.size() != joints.count() + (words.time_s ? 1U : 0U)) return {};
        rest = rest.last(joints.count());
    }
    for (std::size_t i = 0; i < joints.sources.size(); ++i) {
        const LineJoints::Source& source = joints.sources[i];
        JointSample sample;
        sample.source = i;
        if (words.are_named) {
            sample.position = position_of(words, source);
            if (sample.position.empty()) continue;
            if (sample.position.size() < source.names.size()) return {};
        } else {
            const auto own = rest.first(source.names.size());
            sample.position.assign(own.begin(), own.end());
            rest = rest.subspan(source.names.size());
        }
        unwind(source, sample.position);
        samples.push_back(std::move(sample));
    }
    return samples;
}

/// The usual error of a time that is not CLOCK_MONOTONIC in seconds.
std::string guess_at(double time, double now_s) {
    constexpr double kYear2001S = 1e9;
    constexpr std::array<std::pair<double, const char*>, 3> kUnits = {
        {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}};
    for (const auto& [per_s, name] : kUnits)
        if (std::abs(time / per_s - now_s) <= kTimeOffMaxS) return std::string(": it looks like ") + name;
    return time >= kYear2001S ? ": it looks like wall time" : "";
}

std::string describe_too_large(const Words& words, const LineJoints& joints) {
    std::size_t number = 0;
    for (const JointSample& sample : samples_of(words, joints)) {
        const LineJoints::Source& source = joints.sources[sample.source];
        for (std::size_t i = 0; i < sample.position.size(); ++i) {
            ++number;
            if (!is_too_large(sample.position[i])) continue;
            const std::string joint =
                words.are_named ? source.names[i] : fmt::format("joint {} of {}", number, joints.count());
            return fmt::format(": {} is {}, beyond +-{}: degrees, or millimetres?", joint, sample.position[i],
                               LocalJoints::kLargest);
        }
    }
    return {};
}

/// The source of which a line of names has some joints, and one that is missing.
std::string describe_missing(const Words& words, const LineJoints& joints) {
    for (const LineJoints::Source& source : joints.sources) {
        const auto is_here = [&](const std::string& name) { return words.by_name.contains(name); };
        const auto missing = std::ranges::find_if_not(source.names, is_here);
        if (missing != source.names.end() && std::ranges::any_of(source.names, is_here))
            return fmt::format("without {}, which the rig has in one source with the others", *missing);
    }
    return "no name of a joint that comes through the socket";
}

}  // namespace

std::size_t LineJoints::count() const {
    std::size_t count = 0;
    for (const Source& source : sources) count += source.names.size();
    return count;
}

LineJoints LineJoints::local(const HostRig& rig, std::span<const JointLimits> limits) {
    LineJoints joints;
    std::size_t first = 0;
    for (std::size_t i = 0; i < rig.joint_sources.size(); ++i) {
        const HostJointSource& source = rig.joint_sources[i];
        const auto of_source = limits.subspan(first, source.joints.size());
        first += source.joints.size();
        if (!source.is_local) continue;
        joints.sources.push_back({i, source.joints, source.rate_hz, {}});
        for (const JointLimits& limit : of_source)
            joints.sources.back().turns.push_back(std::isinf(limit.min));
    }
    return joints;
}

Result<JointLine, JointTextFault> parse_joints(std::string_view text, const LineJoints& joints, HostTime now,
                                               std::optional<HostTime> came) {
    if (text.size() > kJointTextMax) return unexpected(JointTextFault::too_long);
    const auto words = read_words(text, joints);
    if (!words) return unexpected(JointTextFault::not_a_number);
    const bool has_time = words->time_s.has_value();
    if (has_time && std::abs(*words->time_s - seconds_at(now)) > kTimeOffMaxS)
        return unexpected(JointTextFault::time_off);
    JointLine line{.samples = samples_of(*words, joints), .came = {}, .has_own_time = has_time};
    if (line.samples.empty()) return unexpected(JointTextFault::wrong_count);
    if (!came && !has_time) return unexpected(JointTextFault::time_off);
    for (JointSample& sample : line.samples) {
        if (std::ranges::any_of(sample.position, is_too_large)) return unexpected(JointTextFault::too_large);
        sample.has_own_time = has_time;
        sample.sampled = has_time ? HostTime{std::llround(*words->time_s * kNsPerS)} : *came;
    }
    return line;
}

std::string describe(JointTextFault fault, std::string_view text, const LineJoints& joints, HostTime now) {
    std::string name = names_of(fault).at(static_cast<std::size_t>(fault));
    if (fault == JointTextFault::too_long) return fmt::format("{}: over {} bytes", name, kJointTextMax);
    const auto words = read_words(text, joints);
    if (!words) return fmt::format("{}: \"{}\"", name, words.error());
    if (fault == JointTextFault::wrong_count && words->are_named)
        return fmt::format("{}: {}", name, describe_missing(*words, joints));
    if (fault == JointTextFault::wrong_count)
        return fmt::format("{}: {} numbers, the rig has {} joints", name, words->numbers.size(),
                           joints.count());
    if (fault == JointTextFault::too_large) return name + describe_too_large(*words, joints);
    if (!words->time_s) return name;
    return fmt::format("{}: {}, and CLOCK_MONOTONIC here is {:.3f}{}", name, *words->time_s, seconds_at(now),
                       guess_at(*words->time_s, seconds_at(now)));
}

}  // namespace octoskin
