#include "host/apps/daemon/joint_socket.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "host/apps/daemon/unix_socket.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

namespace octoskin {
namespace {

constexpr double kNsPerS = 1e9;
constexpr double kTimeOffMaxS = 1.0;

/// The numbers in `text`, between blanks; empty if a word is none.
std::optional<std::vector<double>> numbers_of(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r\n,";
    std::vector<double> numbers;
    while (true) {  // each round takes one word off
        const std::size_t begin = text.find_first_not_of(kBlank);
        if (begin == std::string_view::npos) return numbers;
        text.remove_prefix(begin);
        const std::string_view word = text.substr(0, text.find_first_of(kBlank));
        double number = 0.0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const bool is_whole = error == std::errc{} && end == word.data() + word.size();
        if (!is_whole || !std::isfinite(number)) return std::nullopt;
        numbers.push_back(number);
        text.remove_prefix(word.size());
    }
}

}  // namespace

Result<JointSample, JointTextFault> parse_joints(std::string_view text, std::size_t joint_count, HostTime now,
                                                 std::optional<HostTime> came) {
    if (text.size() > kJointTextMax) return unexpected(JointTextFault::too_long);
    auto numbers = numbers_of(text);
    if (!numbers) return unexpected(JointTextFault::not_a_number);
    JointSample sample{came.value_or(HostTime{}), std::move(*numbers), {}};
    const bool is_dated = came || sample.position.size() == joint_count + 1;
    if (sample.position.size() == joint_count + 1) {
        const double time_s = sample.position.front();
        if (std::abs(time_s - static_cast<double>(now.ns) / kNsPerS) > kTimeOffMaxS)
            return unexpected(JointTextFault::time_off);
        sample.sampled.ns = std::llround(time_s * kNsPerS);
        sample.position.erase(sample.position.begin());
    }
    if (sample.position.size() != joint_count) return unexpected(JointTextFault::wrong_count);
    if (!is_dated) return unexpected(JointTextFault::time_off);
    const bool is_too_large = std::ranges::any_of(
        sample.position, [](double position) { return std::abs(position) > LocalJoints::kLargest; });
    if (is_too_large) return unexpected(JointTextFault::too_large);
    return sample;
}

std::string describe(JointTextFault fault, std::string_view text, std::size_t joint_count) {
    const std::string name = names_of(fault).at(static_cast<std::size_t>(fault));
    const auto numbers = numbers_of(text);
    if (fault != JointTextFault::wrong_count || !numbers) return name;
    return fmt::format("{}: {} numbers, the rig has {} joints", name, numbers->size(), joint_count);
}

Result<JointSocket, AppError> JointSocket::open(const std::filesystem::path& file, std::size_t joint_count) {
    const auto descriptor = bind_unix_socket(file, SOCK_DGRAM);
    if (!descriptor) return unexpected(descriptor.error());
    (void)socketcan::want_stamps(*descriptor);
    try {
        return JointSocket(file, std::make_unique<DatagramFeed>(*descriptor, kJointTextMax + 1), joint_count);
    } catch (const std::system_error& error) {
        ::close(*descriptor);
        ::unlink(file.c_str());
        return fail(ExitCode::unavailable, fmt::format("{}: {}", file.string(), error.what()));
    }
}

JointSocket& JointSocket::operator=(JointSocket&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(feed_, other.feed_);
    joint_count_ = other.joint_count_;
    samples_ = other.samples_;
    faults_ = other.faults_;
    return *this;
}

JointSocket::~JointSocket() {
    if (!feed_) return;
    ::unlink(file_.c_str());  // while it still answers: nobody else has the name yet
}

bool JointSocket::receive(std::optional<JointSample>& sample) {
    sample.reset();
    const auto datagram = feed_->take();
    if (!datagram) return false;
    auto parsed = parse_joints(datagram->bytes, joint_count_, datagram->read, datagram->came_at);
    if (parsed) {
        ++samples_;
        sample = std::move(parsed).value();
        sample->came = datagram->came;
    } else {
        ++faults_.at(static_cast<std::size_t>(parsed.error()));
    }
    return true;
}

}  // namespace octoskin
