#include "host/apps/daemon/depth_recorder.hpp"

#include <utility>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/io/openni2/oni_writer.hpp"

namespace octoskin {
namespace {

std::size_t bytes_of(const DepthFrame& frame) {
    return frame.depth_mm.size() * sizeof(frame.depth_mm.front());
}

}  // namespace

DepthRecorder::DepthRecorder(std::filesystem::path oni, std::filesystem::path epoch)
    : oni_(std::move(oni)), epoch_(std::move(epoch)) {
    thread_ = start_without_signals([this] { work(); });
}

DepthRecorder::~DepthRecorder() {
    {
        const std::lock_guard lock(mutex_);
        is_dropped_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

bool DepthRecorder::add(const DepthFrame& frame) {
    {
        const std::lock_guard lock(mutex_);
        if (!error_.empty() || waiting_bytes_ + bytes_of(frame) > kWaitingMax) return false;
        waiting_.push_back(frame);
        waiting_bytes_ += bytes_of(frame);
    }
    changed_.notify_all();
    return true;
}

std::string DepthRecorder::finish() {
    {
        const std::lock_guard lock(mutex_);
        is_finishing_ = true;
    }
    changed_.notify_all();
    thread_.join();
    return error();
}

std::string DepthRecorder::error() const {
    const std::lock_guard lock(mutex_);
    return error_;
}

std::optional<DepthFrame> DepthRecorder::next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !waiting_.empty() || is_finishing_ || is_dropped_; });
    if (waiting_.empty() || is_dropped_) return std::nullopt;
    DepthFrame frame = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= bytes_of(frame);
    return frame;
}

void DepthRecorder::work() {
    std::string error = record();
    const std::lock_guard lock(mutex_);
    error_ = std::move(error);
}

std::string DepthRecorder::record() {
    auto frame = next();
    if (!frame) return {};
    auto writer = openni2::OniWriter::create(oni_, epoch_, {frame->width, frame->height});
    if (!writer) return writer.error().what;
    for (; frame; frame = next()) {
        if (const auto written = writer->write(frame->captured, frame->depth_mm); !written)
            return written.error().what;
    }
    const auto closed = writer->close();
    return closed ? std::string() : closed.error().what;
}

}  // namespace octoskin
