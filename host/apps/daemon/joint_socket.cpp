#include "host/apps/daemon/joint_socket.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <span>
#include <system_error>
#include <utility>

#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/query/joint_lines.hpp"
#include "host/apps/recording/shortage.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

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

/// The usual error of a time that is not CLOCK_MONOTONIC in seconds.
std::string guess_at(double time, double now_s) {
    constexpr double kYear2001S = 1e9;
    constexpr std::array<std::pair<double, const char*>, 3> kUnits = {
        {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}};
    for (const auto& [per_s, name] : kUnits)
        if (std::abs(time / per_s - now_s) <= kTimeOffMaxS) return std::string(": it looks like ") + name;
    return time >= kYear2001S ? ": it looks like wall time" : "";
}

/// `numbers`: as many as joints, and maybe a time before them.
std::string describe_too_large(std::span<const double> numbers, std::size_t joint_count) {
    const auto positions = numbers.last(std::min(joint_count, numbers.size()));
    const auto found = std::ranges::find_if(positions, is_too_large);
    if (found == positions.end()) return {};
    return fmt::format(": joint {} of {} is {}, beyond +-{}: degrees, or millimetres?",
                       found - positions.begin() + 1, joint_count, *found, LocalJoints::kLargest);
}

}  // namespace

Result<JointSample, JointTextFault> parse_joints(std::string_view text, std::size_t joint_count, HostTime now,
                                                 std::optional<HostTime> came) {
    if (text.size() > kJointTextMax) return unexpected(JointTextFault::too_long);
    auto numbers = read_numbers(text);
    if (!numbers) return unexpected(JointTextFault::not_a_number);
    JointSample sample{came.value_or(HostTime{}), std::move(*numbers), {}};
    const bool is_dated = came || sample.position.size() == joint_count + 1;
    if (sample.position.size() == joint_count + 1) {
        const double time_s = sample.position.front();
        if (std::abs(time_s - seconds_at(now)) > kTimeOffMaxS) return unexpected(JointTextFault::time_off);
        sample.sampled.ns = std::llround(time_s * kNsPerS);
        sample.has_own_time = true;
        sample.position.erase(sample.position.begin());
    }
    if (sample.position.size() != joint_count) return unexpected(JointTextFault::wrong_count);
    if (!is_dated) return unexpected(JointTextFault::time_off);
    if (std::ranges::any_of(sample.position, is_too_large)) return unexpected(JointTextFault::too_large);
    return sample;
}

std::string describe(JointTextFault fault, std::string_view text, std::size_t joint_count, HostTime now) {
    std::string name = names_of(fault).at(static_cast<std::size_t>(fault));
    if (fault == JointTextFault::too_long) return fmt::format("{}: over {} bytes", name, kJointTextMax);
    const auto read = read_numbers(text);
    if (!read) return fmt::format("{}: \"{}\"", name, read.error());
    const std::vector<double>& numbers = *read;
    if (fault == JointTextFault::wrong_count)
        return fmt::format("{}: {} numbers, the rig has {} joints", name, numbers.size(), joint_count);
    if (fault == JointTextFault::too_large) return name + describe_too_large(numbers, joint_count);
    if (numbers.size() != joint_count + 1) return name;  // it has no time
    return fmt::format("{}: {}, and CLOCK_MONOTONIC here is {:.3f}{}", name, numbers.front(), seconds_at(now),
                       guess_at(numbers.front(), seconds_at(now)));
}

Result<JointSocket, AppError> JointSocket::open(const std::filesystem::path& file, std::size_t joint_count) {
    const auto descriptor = bind_unix_socket(file, SOCK_DGRAM, "--joints");
    if (!descriptor) return unexpected(descriptor.error());
    try {
        if (!socketcan::want_stamps(*descriptor) || !socketcan::want_senders(*descriptor))
            throw std::system_error(errno, std::generic_category(), "cannot enable time stamps and senders");
        return JointSocket(file, std::make_unique<DatagramFeed>(*descriptor, kJointTextMax + 1), joint_count);
    } catch (const std::system_error& error) {
        socketcan::close_socket(*descriptor);
        ::unlink(file.c_str());
        AppError why = shortage_in(error).value_or(
            AppError{ExitCode::unavailable, {ErrorCode::system_error, error.what()}});
        return fail(why.exit, in_file(std::move(why.error), file));
    }
}

JointSocket& JointSocket::operator=(JointSocket&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(feed_, other.feed_);
    joint_count_ = other.joint_count_;
    senders_ = std::move(other.senders_);
    samples_ = other.samples_;
    second_begun_ = other.second_begun_;
    second_samples_ = other.second_samples_;
    rate_hz_ = other.rate_hz_;
    faults_ = other.faults_;
    refused_ = std::move(other.refused_);
    return *this;
}

JointSocket::~JointSocket() {
    if (!feed_) return;
    ::unlink(file_.c_str());  // while it still answers, so that no other process has the name yet
}

bool JointSocket::receive(std::optional<JointSample>& sample) {
    sample.reset();
    const auto datagram = feed_->take();
    if (!datagram) return false;
    auto parsed = parse_joints(datagram->bytes, joint_count_, datagram->read, datagram->came_at);
    if (parsed) {
        ++samples_;
        feed_->keep(*datagram);
        sample = std::move(parsed).value();
        sample->came = datagram->came;
        const HostTime at = datagram->came_at.value_or(datagram->read);
        count_rate(at);
        senders_.hear(datagram->sender, at);
        sample->is_of_several = senders_.are_several(at);
    } else {
        ++faults_.at(static_cast<std::size_t>(parsed.error()));
        refused_ = datagram->sender;
    }
    return true;
}

void JointSocket::count_rate(HostTime at) {
    constexpr Nanoseconds kSecond{1'000'000'000};
    const Nanoseconds passed = at - second_begun_;
    if (passed >= kSecond) {
        rate_hz_ =
            passed < 2 * kSecond ? static_cast<double>(second_samples_) / seconds_at({passed.count()}) : 0.0;
        second_begun_ = at;
        second_samples_ = 0;
    }
    ++second_samples_;
}

double JointSocket::rate_hz(HostTime now) const {
    constexpr Nanoseconds kOver{2'000'000'000};
    return now - second_begun_ < kOver ? rate_hz_ : 0.0;
}

}  // namespace octoskin
