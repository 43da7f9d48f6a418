#include "host/io/openni2/helpers/oni_recorder.hpp"

#include <thread>

#include "host/io/openni2/helpers/oni_outline.hpp"
#include "host/io/openni2/helpers/virtual_stream.hpp"

namespace octoskin::openni2 {
namespace {

using namespace std::chrono_literals;

constexpr int kFps = 30;  // OpenNI2 requires a rate; the time stamps contain the true one
constexpr std::chrono::milliseconds kPatience = 10s;
constexpr int kStartsMax = 5;

constexpr const char* kVanished =
    "the file was removed during recording; record again, and leave it in place until the end";

/// 0 for a missing file: it may be removed at any time.
std::uintmax_t size_of(const std::filesystem::path& file) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    return error ? 0 : size;
}

/// Under any name: an open file can exist without one.
bool is_there(const std::filesystem::path& file) {
    std::error_code error;
    const std::uintmax_t names = std::filesystem::hard_link_count(file, error);
    return !error && names > 0;
}

std::string with_reason(const std::string& what) {
    const std::string reason = openni::OpenNI::getExtendedError();
    return reason.empty() ? what : what + ": " + reason;
}

template <class Condition>
bool wait_for(const Condition& is_met, std::chrono::milliseconds patience) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!is_met()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(200us);
    }
    return true;
}

}  // namespace

std::string OniRecorder::open() {
    if (openni::OpenNI::initialize() != openni::STATUS_OK) return with_reason("cannot start OpenNI2");
    const std::string uri = std::string(kVirtualUriPrefix) + std::to_string(size_.width) + "x" +
                            std::to_string(size_.height) + "@" + std::to_string(kFps);
    if (device_.open(uri.c_str()) != openni::STATUS_OK)
        return with_reason("OpenNI2 does not find the driver of the virtual camera where it searches");
    if (stream_.create(device_, openni::SENSOR_DEPTH) != openni::STATUS_OK ||
        stream_.start() != openni::STATUS_OK)
        return with_reason("the virtual camera does not start");
    return "";
}

std::string OniRecorder::start() {
    recorder_ = std::make_unique<openni::Recorder>();
    if (recorder_->create(file_.c_str()) != openni::STATUS_OK) return with_reason("cannot create the file");
    if (recorder_->attach(stream_) != openni::STATUS_OK || recorder_->start() != openni::STATUS_OK)
        return with_reason("the recorder does not start");
    if (!wait_for([&] { return outline_of(file_).has_begun; }, kPatience))
        return "the recorder does not begin the file; is the disk full?";
    // After that record the recorder's thread has one more assignment to execute before it accepts frames.
    std::this_thread::sleep_for(5ms);
    return "";
}

std::string OniRecorder::begin(const PipedFrame* first) {
    if (first == nullptr) return start();
    // If the thread was delayed beyond those 5 ms, the frame is missing in the file, and a restart loses
    // nothing.
    for (int starts = 0; starts < kStartsMax; ++starts) {
        if (std::string what = start(); !what.empty()) return what;
        if (push(*first, 2s)) return "";
        recorder_.reset();
    }
    return "the recorder accepts no frames; is the disk full?";
}

bool OniRecorder::push(const PipedFrame& frame, std::chrono::milliseconds patience) {
    VirtualFrame pushed{frame.timestamp_us, frames_ + 1, frame.depth_mm.data()};
    const auto size_before = size_of(file_);
    const bool is_written =
        stream_.setProperty(kPropertyPushFrame, &pushed, sizeof(pushed)) == openni::STATUS_OK &&
        wait_for([&] { return size_of(file_) > size_before || !is_there(file_); }, patience) &&
        is_there(file_);
    if (is_written) ++frames_;
    return is_written;
}

std::string OniRecorder::record(const PipedFrame& frame) {
    if (push(frame, kPatience)) return "";
    if (!is_there(file_)) return kVanished;
    return "frame " + std::to_string(frames_ + 1) + " does not reach the file; is the disk full?";
}

std::string OniRecorder::finish() {
    recorder_->stop();
    recorder_->destroy();  // waits for the recorder's thread
    if (!is_there(file_)) return kVanished;
    const OniOutline outline = outline_of(file_);
    if (!outline.length || outline.frames != static_cast<std::uint32_t>(frames_)) {
        return "the file holds " + std::to_string(outline.frames) + " of " + std::to_string(frames_) +
               " frames" + (outline.length ? "" : " and no end") + "; is the disk full?";
    }
    // The recorder truncates at the sum of two positions, which leaves a hole as long as the recording after
    // its end.
    std::error_code error;
    std::filesystem::resize_file(file_, *outline.length, error);
    return error ? "cannot cut the file to its length: " + error.message() : "";
}

}  // namespace octoskin::openni2
