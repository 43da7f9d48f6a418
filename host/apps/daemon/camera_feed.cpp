#include "host/apps/daemon/camera_feed.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/recording/shortage.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helper_process.hpp"

namespace octoskin {
namespace {

constexpr const char* kHelper = "octoskin-camera";
constexpr std::chrono::milliseconds kOpenPatience{15'000};  // a real device takes seconds to start

std::string with_complaint(const std::string& what, openni2::HelperProcess& helper) {
    const std::string complaint = helper.complaint();
    return complaint.empty() ? what : what + " (" + complaint + ")";
}

bool is_oni_name(const std::string& uri) {
    return std::filesystem::path(uri).extension() == ".oni";
}

/// Why the file cannot be played; empty if it may be playable.
std::string fault_of_file(const std::string& uri) {
    std::error_code error;
    if (!is_oni_name(uri) || std::filesystem::is_regular_file(uri, error)) return {};
    return uri + (std::filesystem::exists(uri, error) ? ": is not a file" : ": no such file");
}

std::string not_opened(const std::string& uri) {
    if (uri.empty()) return "no camera found: is one plugged in, with an OpenNI2 driver?";
    return uri + (is_oni_name(uri) ? ": no .oni file with depth that OpenNI2 can play"
                                   : ": no camera with depth there");
}

}  // namespace

CameraFeed::CameraFeed(std::string uri, std::chrono::milliseconds silence_max,
                       std::optional<std::filesystem::path> helper, std::optional<openni2::CameraMode> mode)
    : uri_(std::move(uri)),
      silence_max_(silence_max),
      helper_(std::move(helper)),
      mode_(mode),
      event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC | EFD_SEMAPHORE)),
      end_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (event_ < 0 || end_ < 0)
        throw std::system_error(errno, std::generic_category(), "cannot make an eventfd");
    record_.why = "not opened yet";
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
    changed_.notify_all();
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
        } catch (const std::exception& thrown) {  // no memory for a frame, or for the helper
            note_closed(reason_of(thrown));
        }
        wait_before_retry();
    }
    has_ended_ = true;
}

void CameraFeed::wait_before_retry() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kRetry, [this] { return is_ending_.load(); });
}

void CameraFeed::watch_camera() {
    if (const std::string fault = fault_of_file(uri_); !fault.empty()) return note_closed(fault);
    const auto helper = openni2::find_helper(kHelper, helper_);
    if (!helper) return note_closed(helper.error());
    std::vector<std::string> arguments{uri_};
    if (mode_) arguments.push_back(to_text(*mode_));
    auto process = openni2::HelperProcess::start(*helper, arguments, openni2::HelperPipe::its_output,
                                                 openni2::HelperComplaints::kept);
    if (!process) return note_closed(process.error());
    std::error_code error;
    const auto film_bytes = std::filesystem::file_size(uri_, error);
    const auto patience = kOpenPatience + openni2::time_to_check(error ? 0 : film_bytes);
    const auto header = openni2::FramePipe(process->descriptor(), patience, end_).read_header();
    if (!header) return note_closed(with_complaint(not_opened(uri_), *process));
    note_opened(header->rate_mhz * 1e-3);
    openni2::FramePipe frames(process->descriptor(), silence_max_, end_);
    images_.begin_opening();
    while (!is_ending_) {
        auto frame = frames.read_frame(header->size);
        if (!frame || !frame->has_value()) {
            const std::string what = frame ? "it ended" : name(frame.error());
            return note_closed(with_complaint(what, *process));
        }
        if (!(*frame)->is_timed) {
            note_untimed();
            continue;
        }
        const HostTime captured{static_cast<std::int64_t>((*frame)->timestamp_us) * 1000};
        DepthFrame taken{captured, header->size.width, header->size.height, std::move((*frame)->depth_mm)};
        if (is_oni_name(uri_) || !images_.take(taken)) {
            put(std::move(taken));
            continue;
        }
        note_repeated();
        if (images_.has_value() && images_.lasted() > silence_max_)
            return note_closed(with_complaint("it shows one image again and again", *process));
    }
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
