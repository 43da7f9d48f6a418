#include "host/apps/daemon/depth_recorder.hpp"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

#include "host/apps/recording/shortage.hpp"
#include "host/io/openni2/oni_writer.hpp"

namespace octoskin {
namespace {

constexpr Nanoseconds kFinishPatience{60'000'000'000};
constexpr Nanoseconds kDropPatience{100'000'000};

std::size_t bytes_of(const DepthFrame& frame) {
    return frame.depth_mm.size() * sizeof(frame.depth_mm.front());
}

}  // namespace

/// State shared with the thread, which may outlive the recorder.
class DepthRecorder::Work {
  public:
    Work(FilePlace oni, FilePlace epoch) : oni_(std::move(oni)), epoch_(std::move(epoch)) {}

    void run() {
        Status<Error> outcome = Done{};
        try {
            outcome = record();
        } catch (const std::exception& thrown) {  // no memory, no thread
            outcome = unexpected(in_file(error_in(thrown), oni_.shown()));
        }
        const std::lock_guard lock(mutex_);
        if (!outcome) error_ = outcome.error();
    }
    [[nodiscard]] bool add(const DepthFrame& frame) {
        {
            const std::lock_guard lock(mutex_);
            if (error_ || waiting_bytes_ + bytes_of(frame) > kWaitingMax) return false;
            waiting_.push_back(frame);
            waiting_bytes_ += bytes_of(frame);
        }
        changed_.notify_all();
        return true;
    }
    void begin() {
        {
            const std::lock_guard lock(mutex_);
            may_begin_ = true;
        }
        changed_.notify_all();
    }
    /// Ends after the waiting frames, or immediately.
    void end(bool is_at_once) {
        {
            const std::lock_guard lock(mutex_);
            is_finishing_ = true;
            is_dropped_ = is_dropped_ || is_at_once;
        }
        changed_.notify_all();
    }
    [[nodiscard]] std::optional<Error> error() const {
        const std::lock_guard lock(mutex_);
        return error_;
    }

  private:
    /// Empty if no further frame will come.
    [[nodiscard]] std::optional<DepthFrame> next() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return (may_begin_ && !waiting_.empty()) || is_finishing_; });
        if (waiting_.empty() || is_dropped_ || !may_begin_) return std::nullopt;
        DepthFrame frame = std::move(waiting_.front());
        waiting_.pop_front();
        waiting_bytes_ -= bytes_of(frame);
        return frame;
    }
    [[nodiscard]] Status<Error> record() {
        auto frame = next();
        if (!frame) return Done{};
        auto writer = openni2::OniWriter::create(oni_, epoch_, {frame->width, frame->height});
        if (!writer) return unexpected(writer.error());
        for (; frame; frame = next()) {
            if (const auto written = writer->write(frame->captured, frame->depth_mm); !written)
                return written;
        }
        return writer->close();
    }

    FilePlace oni_;
    FilePlace epoch_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<DepthFrame> waiting_;
    std::size_t waiting_bytes_ = 0;
    bool may_begin_ = false;
    bool is_finishing_ = false;
    bool is_dropped_ = false;
    std::optional<Error> error_;
};

DepthRecorder::DepthRecorder(FilePlace oni, FilePlace epoch)
    : work_(std::make_shared<Work>(std::move(oni), std::move(epoch))),
      thread_([shared = work_] { shared->run(); }) {}

DepthRecorder::~DepthRecorder() {
    work_->end(true);
    (void)thread_.end(kDropPatience);
}

void DepthRecorder::begin() {
    work_->begin();
}

bool DepthRecorder::add(const DepthFrame& frame) {
    return work_->add(frame);
}

std::optional<Error> DepthRecorder::finish() {
    work_->end(false);
    if (!thread_.end(kFinishPatience))
        return Error{ErrorCode::time_limit, "depth frames were not written within a minute"};
    return work_->error();
}

std::optional<Error> DepthRecorder::error() const {
    return work_->error();
}

}  // namespace octoskin
