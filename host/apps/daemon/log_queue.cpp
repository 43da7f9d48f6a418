#include "host/apps/daemon/log_queue.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/details/log_msg_buffer.h>
#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <exception>
#include <mutex>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/log_limit.hpp"

namespace octoskin {
namespace {

/// Counter of the queue that is this process's log; null: there is none.
std::atomic<const std::atomic<std::size_t>*> waiting_at_crash = nullptr;
static_assert(std::atomic<std::size_t>::is_always_lock_free, "it is read in a signal handler");

}  // namespace

/// State shared with the thread, which may outlive the queue.
class LogQueue::Work {
  public:
    Work(std::vector<spdlog::sink_ptr> sinks, std::size_t bytes_max)
        : sinks_(std::move(sinks)), bytes_max_(bytes_max) {}

    void run();
    void add(const spdlog::details::log_msg& message);
    void end();
    [[nodiscard]] LogRecord record() const;
    [[nodiscard]] const std::atomic<std::size_t>& waiting() const { return waiting_; }
    [[nodiscard]] const std::vector<spdlog::sink_ptr>& sinks() const { return sinks_; }

  private:
    struct Line {
        spdlog::details::log_msg_buffer message;
        std::uint64_t dropped_before = 0;
    };
    /// Bytes of a line beside its text.
    static constexpr std::size_t kLineBytes = sizeof(Line);
    [[nodiscard]] static std::size_t bytes_of(const spdlog::details::log_msg& message) {
        return message.payload.size() + kLineBytes;
    }
    void write(const Line& line);
    void report_dropped(std::uint64_t count);

    std::vector<spdlog::sink_ptr> sinks_;
    std::size_t bytes_max_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Line> lines_;
    std::size_t bytes_ = 0;                 ///< of `lines_`
    std::uint64_t dropped_ = 0;             ///< in all
    std::uint64_t dropped_unreported_ = 0;  ///< since the newest line that waits
    std::optional<HostTime> writing_since_;
    bool is_ending_ = false;
    std::atomic<std::size_t> waiting_ = 0;  ///< includes the one being written
};

void LogQueue::Work::add(const spdlog::details::log_msg& message) {
    {
        const std::lock_guard lock(mutex_);
        const std::size_t bytes = bytes_of(message);
        try {
            if (bytes_ + bytes > bytes_max_) throw std::bad_alloc();
            lines_.push_back({spdlog::details::log_msg_buffer(message), dropped_unreported_});
        } catch (const std::bad_alloc&) {  // no memory of any kind
            ++dropped_;
            ++dropped_unreported_;
            return;
        }
        dropped_unreported_ = 0;
        bytes_ += bytes;
        ++waiting_;
    }
    changed_.notify_one();
}

void LogQueue::Work::run() {
    std::unique_lock lock(mutex_);
    while (true) {  // until the end
        changed_.wait(lock, [this] { return !lines_.empty() || is_ending_; });
        if (lines_.empty()) return;
        const Line line = std::move(lines_.front());
        lines_.pop_front();
        bytes_ -= bytes_of(line.message);
        // If no line behind it can report them.
        const std::uint64_t dropped_after = lines_.empty() ? std::exchange(dropped_unreported_, 0) : 0;
        writing_since_ = monotonic_now();
        lock.unlock();
        try {
            write(line);
            report_dropped(dropped_after);
        } catch (const std::exception&) {  // it cannot be logged
        }
        lock.lock();
        writing_since_.reset();
        --waiting_;
    }
}

void LogQueue::Work::write(const Line& line) {
    report_dropped(line.dropped_before);
    for (const auto& each : sinks_)
        if (each->should_log(line.message.level)) each->log(line.message);
}

void LogQueue::Work::report_dropped(std::uint64_t count) {
    if (count == 0) return;
    const std::string text = fmt::format(
        "{} lines are left out here, because the reader of the log took none for too long", count);
    for (const auto& each : sinks_)
        if (each->should_log(spdlog::level::warn))
            each->log(spdlog::details::log_msg("octoskin", spdlog::level::warn, text));
}

void LogQueue::Work::end() {
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_one();
}

LogRecord LogQueue::Work::record() const {
    const std::lock_guard lock(mutex_);
    return {dropped_, waiting_, writing_since_};
}

LogQueue::LogQueue(std::vector<spdlog::sink_ptr> sinks, std::size_t bytes_max, Nanoseconds end_patience)
    : work_(std::make_shared<Work>(std::move(sinks), bytes_max)),
      end_patience_(end_patience),
      thread_([shared = work_] { shared->run(); }) {}

LogQueue::~LogQueue() {
    const auto* own = &work_->waiting();
    (void)waiting_at_crash.compare_exchange_strong(own, nullptr);
    work_->end();
    (void)thread_.end(end_patience_);
}

void LogQueue::log(const spdlog::details::log_msg& message) {
    if (message.payload.size() <= kLineMax) return work_->add(message);
    const std::string text = fmt::format(
        "{}... ({} bytes)", std::string_view(message.payload.data(), kLineMax), message.payload.size());
    spdlog::details::log_msg shorter = message;
    shorter.payload = text;
    work_->add(shorter);
}

void LogQueue::set_pattern(const std::string& pattern) {
    for (const auto& each : work_->sinks()) each->set_pattern(pattern);
}

void LogQueue::set_formatter(std::unique_ptr<spdlog::formatter> formatter) {
    for (const auto& each : work_->sinks()) each->set_formatter(formatter->clone());
}

LogRecord LogQueue::record() const {
    return work_->record();
}

const std::atomic<std::size_t>& LogQueue::waiting() const {
    return work_->waiting();
}

namespace {

/// Does only what a signal handler may do. The signal's default action, restored by then, follows.
void wait_for_log(int signal) {
    constexpr long kStepNs = 10'000'000;
    const auto* const waiting = waiting_at_crash.load();
    for (Nanoseconds waited{0}; waiting != nullptr && *waiting > 0 && waited < LogQueue::kEndPatience;
         waited += Nanoseconds{kStepNs}) {
        const timespec step{.tv_sec = 0, .tv_nsec = kStepNs};
        (void)::nanosleep(&step, nullptr);
    }
    (void)::raise(signal);
}

/// Replaces the library's message, which waits for the reader of standard error.
[[noreturn]] void log_and_abort() {
    try {
        if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
        spdlog::critical("a defect of octoskin, please report it: terminated");
    } catch (const std::exception& thrown) {
        spdlog::critical("a defect of octoskin, please report it: {}", thrown.what());
    } catch (...) {
        spdlog::critical("a defect of octoskin, please report it: an exception of an unknown type");
    }
    std::abort();
}

/// Writes to standard error, but not through `stderr`: a write that hangs there would hold its lock, which
/// the end of a process takes.
spdlog::sink_ptr make_sink() {
    const int descriptor = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    std::FILE* const file = descriptor < 0 ? nullptr : ::fdopen(descriptor, "w");  // never closed
    if (file == nullptr) throw std::system_error(errno, std::generic_category(), "standard error");
    (void)std::setvbuf(file, nullptr, _IONBF, 0);
    return std::make_shared<spdlog::sinks::ansicolor_sink<spdlog::details::console_mutex>>(
        file, spdlog::color_mode::automatic);
}

/// Leaves a signal alone that another part handles already, as a sanitizer does.
void write_log_before_crash(const LogQueue& queue) {
    waiting_at_crash = &queue.waiting();
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
        struct sigaction found {};
        if (::sigaction(signal, nullptr, &found) != 0 || found.sa_handler != SIG_DFL) continue;
        struct sigaction ours {};
        ours.sa_handler = wait_for_log;
        ours.sa_flags = static_cast<int>(SA_RESETHAND);
        (void)::sigaction(signal, &ours, nullptr);
    }
    std::set_terminate(log_and_abort);
}

}  // namespace

std::shared_ptr<const LogQueue> guard_log() {
    const auto queue = std::make_shared<LogQueue>(std::vector<spdlog::sink_ptr>{make_sink()});
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "octoskin", std::make_shared<LogLimit>(std::vector<spdlog::sink_ptr>{queue})));
    write_log_before_crash(*queue);
    return queue;
}

}  // namespace octoskin
