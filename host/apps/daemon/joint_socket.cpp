#include "host/apps/daemon/joint_socket.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <ctime>
#include <utility>

#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/core/ingest/local_joints.hpp"

namespace octoskin {
namespace {

constexpr double kNsPerS = 1e9;
constexpr double kTimeOffMaxS = 1.0;
constexpr std::int64_t kAgeMaxNs = 1'000'000'000;

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

/// On the monotonic clock, by the kernel's stamp: the datagram may have waited.
HostTime arrival_of(msghdr& message) {
    const HostTime now = monotonic_now();
    const WallTime wall = wall_now();
    const cmsghdr* const beside = CMSG_FIRSTHDR(&message);
    const bool is_stamped =
        beside != nullptr && beside->cmsg_level == SOL_SOCKET && beside->cmsg_type == SO_TIMESTAMPNS;
    if (!is_stamped) return now;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(beside), sizeof(stamp));
    const std::int64_t age_ns = wall.ns - (std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec);
    // A wall clock that was set meanwhile tells no age.
    return age_ns >= 0 && age_ns < kAgeMaxNs ? HostTime{now.ns - age_ns} : now;
}

}  // namespace

Result<JointSample, JointTextFault> parse_joints(std::string_view text, std::size_t joint_count,
                                                 HostTime now) {
    if (text.size() > kJointTextMax) return unexpected(JointTextFault::too_long);
    auto numbers = numbers_of(text);
    if (!numbers) return unexpected(JointTextFault::not_a_number);
    JointSample sample{now, std::move(*numbers)};
    if (sample.position.size() == joint_count + 1) {
        const double time_s = sample.position.front();
        if (std::abs(time_s - static_cast<double>(now.ns) / kNsPerS) > kTimeOffMaxS)
            return unexpected(JointTextFault::time_off);
        sample.sampled.ns = std::llround(time_s * kNsPerS);
        sample.position.erase(sample.position.begin());
    }
    if (sample.position.size() != joint_count) return unexpected(JointTextFault::wrong_count);
    const bool is_too_large = std::ranges::any_of(
        sample.position, [](double position) { return std::abs(position) > LocalJoints::kLargest; });
    if (is_too_large) return unexpected(JointTextFault::too_large);
    return sample;
}

Result<JointSocket, AppError> JointSocket::open(const std::filesystem::path& file, std::size_t joint_count) {
    const auto descriptor = bind_unix_socket(file, SOCK_DGRAM);
    if (!descriptor) return unexpected(descriptor.error());
    const int yes = 1;
    (void)::setsockopt(*descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof(yes));
    return JointSocket(file, *descriptor, joint_count);
}

JointSocket::JointSocket(JointSocket&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      joint_count_(other.joint_count_),
      samples_(other.samples_),
      faults_(other.faults_) {}

JointSocket& JointSocket::operator=(JointSocket&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(descriptor_, other.descriptor_);
    joint_count_ = other.joint_count_;
    samples_ = other.samples_;
    faults_ = other.faults_;
    return *this;
}

JointSocket::~JointSocket() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(file_.c_str());
}

bool JointSocket::receive(std::optional<JointSample>& sample) {
    sample.reset();
    std::array<char, kJointTextMax + 1> text{};
    alignas(cmsghdr) std::array<char, 64> control{};
    iovec part{text.data(), text.size()};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = ::recvmsg(descriptor_, &message, MSG_DONTWAIT);
    if (count < 0) return false;
    auto parsed =
        parse_joints({text.data(), static_cast<std::size_t>(count)}, joint_count_, arrival_of(message));
    if (parsed) {
        ++samples_;
        sample = std::move(parsed).value();
    } else {
        ++faults_.at(static_cast<std::size_t>(parsed.error()));
    }
    return true;
}

}  // namespace octoskin
