#include "host/apps/daemon/camera_feed.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <limits>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/recording/shortage.hpp"

namespace octoskin {
namespace {

/// Empty: no time of this machine's clock.
std::optional<HostTime> host_time_of(const openni2::PipedFrame& frame) {
    constexpr std::uint64_t kMaxUs = std::numeric_limits<std::int64_t>::max() / 1000;
    if (!frame.is_timed || frame.timestamp_us > kMaxUs) return std::nullopt;
    return HostTime{static_cast<std::int64_t>(frame.timestamp_us) * 1000};
}

}  // namespace

CameraFeed::CameraFeed(std::unique_ptr<FrameSource> source, std::chrono::milliseconds repeated_max)
    : source_(std::move(source)),
      repeated_max_(repeated_max),
      event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC | EFD_SEMAPHORE)),
      end_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (event_ < 0 || end_ < 0)
        throw std::system_error(errno, std::generic_category(), "cannot make an eventfd");
    record_.why = source_->why_at_first();
    record_.remedy = source_->remedy();
    record_.begun = monotonic_now();
    try {
        thread_ = start_without_signals([this] { work(); });
    } catch (...) {
        ::close(event_);
        ::close(end_);
        throw;
    }
}

CameraFeed::~CameraFeed() {
    end();
    thread_.join();
    ::close(event_);
    ::close(end_);
}

void CameraFeed::end() {
    const std::uint64_t one = 1;
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    (void)!::write(end_, &one, sizeof(one));
}

std::optional<DepthFrame> CameraFeed::take() {
    std::uint64_t taken = 0;
    (void)!::read(event_, &taken, sizeof(taken));
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    DepthFrame oldest = std::move(waiting_.front());
    waiting_.pop_front();
    return oldest;
}

CameraRecord CameraFeed::record() const {
    const std::lock_guard lock(mutex_);
    return record_;
}

void CameraFeed::work() {
    while (!is_ending_) {
        try {
            watch_camera();
        } catch (const std::exception& thrown) {  // no memory for a frame, or for its source
            note_closed(reason_of(thrown));
            pause();
        }
    }
    has_ended_ = true;
}

void CameraFeed::pause() const {
    pollfd ending{end_, POLLIN, 0};
    (void)::poll(&ending, 1, static_cast<int>(kPause.count()));
}

void CameraFeed::watch_camera() {
    const auto stream = source_->open(end_);
    if (!stream) return note_closed(stream.error());
    note_opened((*stream)->rate_hz());
    images_.begin_opening();
    while (!is_ending_) {
        auto frame = (*stream)->read();
        if (!frame) return note_closed(frame.error());
        const std::string fault = take_in(std::move(*frame), (*stream)->size());
        if (!fault.empty()) return note_closed((*stream)->reason(fault));
    }
}

std::string CameraFeed::take_in(openni2::PipedFrame frame, openni2::FrameSize size) {
    const auto captured = host_time_of(frame);
    if (!captured) {
        note_untimed();
        return {};
    }
    DepthFrame taken{*captured, size.width, size.height, std::move(frame.depth_mm)};
    if (source_->may_repeat() || !images_.take(taken)) {
        put(std::move(taken));
        return {};
    }
    note_repeated();
    const bool hangs = images_.has_value() && images_.lasted() > repeated_max_;
    return hangs ? "it shows one image again and again" : "";
}

void CameraFeed::note_opened(double rate_hz) {
    const std::lock_guard lock(mutex_);
    record_.rate_hz = rate_hz;
    record_.is_open = true;
    record_.why.clear();
    ++record_.opened;
}

void CameraFeed::note_untimed() {
    const std::lock_guard lock(mutex_);
    ++record_.frames;
    ++record_.untimed;
    record_.newest_untimed = monotonic_now();
}

void CameraFeed::note_repeated() {
    const std::lock_guard lock(mutex_);
    ++record_.frames;
    ++record_.repeated;
    record_.repeats_often = images_.are_many();
    record_.newest_repeated = monotonic_now();
}

void CameraFeed::put(DepthFrame frame) {
    const std::uint64_t one = 1;
    const std::lock_guard lock(mutex_);
    if (is_ending_) return;
    ++record_.frames;
    record_.repeats_often = images_.are_many();
    record_.newest = monotonic_now();
    waiting_.push_back(std::move(frame));
    if (waiting_.size() > kWaitingMax) {
        waiting_.pop_front();
        ++record_.displaced;
    } else {
        (void)!::write(event_, &one, sizeof(one));
    }
}

void CameraFeed::note_closed(const std::string& why) {
    const std::lock_guard lock(mutex_);
    record_.is_open = false;
    record_.why = why;
}

}  // namespace octoskin
