#include "host/apps/daemon/joint_socket.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <utility>

#include "host/apps/recording/shortage.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

namespace octoskin {

Result<JointSocket, AppError> JointSocket::open(const std::filesystem::path& file, LineJoints joints) {
    const auto bound = bind_unix_socket(file, SOCK_DGRAM, "--joints");
    if (!bound) return unexpected(bound.error());
    const int descriptor = bound->descriptor;
    try {
        if (!socketcan::want_stamps(descriptor) || !socketcan::want_senders(descriptor))
            throw std::system_error(errno, std::generic_category(), "cannot enable time stamps and senders");
        return JointSocket(bound->file, std::make_unique<DatagramFeed>(descriptor, kJointTextMax + 1),
                           std::move(joints));
    } catch (const std::system_error& error) {
        bound->file.remove();
        socketcan::close_socket(descriptor);
        AppError why = shortage_in(error).value_or(
            AppError{ExitCode::unavailable, {ErrorCode::system_error, error.what()}});
        return fail(why.exit, in_file(std::move(why.error), file));
    }
}

JointSocket& JointSocket::operator=(JointSocket&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(feed_, other.feed_);
    joints_ = std::move(other.joints_);
    records_ = std::move(other.records_);
    samples_of_line_ = std::move(other.samples_of_line_);
    samples_ = other.samples_;
    faults_ = other.faults_;
    refused_ = std::move(other.refused_);
    return *this;
}

JointSocket::~JointSocket() {
    if (!feed_) return;
    file_.remove();  // while it still answers, so that no other process has the name yet
}

void JointSocket::expect(LineJoints joints) {
    std::vector<Record> records(joints.sources.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        const auto before =
            std::ranges::find(joints_.sources, joints.sources[i].names, &LineJoints::Source::names);
        if (before != joints_.sources.end())
            records[i] = std::move(records_[static_cast<std::size_t>(before - joints_.sources.begin())]);
    }
    joints_ = std::move(joints);
    records_ = std::move(records);
    samples_of_line_.clear();
}

bool JointSocket::receive(std::optional<JointSample>& sample) {
    sample.reset();
    if (samples_of_line_.empty()) {
        const auto datagram = feed_->take();
        if (!datagram) return false;
        take(*datagram);
    }
    if (samples_of_line_.empty()) return true;
    sample = std::move(samples_of_line_.front());
    samples_of_line_.pop_front();
    return true;
}

void JointSocket::take(const Datagram& datagram) {
    auto line = parse_joints(datagram.bytes, joints_, datagram.read, datagram.came_at);
    if (!line) {
        ++faults_.at(static_cast<std::size_t>(line.error()));
        refused_ = datagram.sender;
        return;
    }
    feed_->keep(datagram);
    const HostTime at = datagram.came_at.value_or(datagram.read);
    for (JointSample& sample : line->samples) {
        Record& record = records_.at(sample.source);
        ++samples_;
        record.count(at);
        record.senders.hear(datagram.sender, at);
        sample.came = datagram.came;
        sample.is_of_several = record.senders.are_several(at);
        samples_of_line_.push_back(std::move(sample));
    }
}

void JointSocket::Record::count(HostTime at) {
    constexpr Nanoseconds kSecond{1'000'000'000};
    const Nanoseconds passed = at - second_begun;
    if (passed >= kSecond) {
        rate_hz = passed < 2 * kSecond
                      ? static_cast<double>(second_samples) / std::chrono::duration<double>(passed).count()
                      : 0.0;
        second_begun = at;
        second_samples = 0;
    }
    ++second_samples;
    ++samples;
}

double JointSocket::rate_hz(std::size_t source, HostTime now) const {
    constexpr Nanoseconds kOver{2'000'000'000};
    const Record& record = records_.at(source);
    return now - record.second_begun < kOver ? record.rate_hz : 0.0;
}

}  // namespace octoskin
