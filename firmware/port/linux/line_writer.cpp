#include "firmware/port/linux/line_writer.hpp"

#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <mutex>
#include <string_view>
#include <utility>

namespace octoskin::linux_port {

struct LineWriter::Work {
    explicit Work(int descriptor_in) : descriptor(descriptor_in) {}
    int descriptor;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::string> lines;
    std::size_t dropped = 0;  ///< since the newest queued line
    bool is_ending = false;
    bool has_ended = false;
};

namespace {

void write_all(int descriptor, std::string_view rest) {
    while (!rest.empty()) {  // each iteration writes a part
        const ssize_t count = ::write(descriptor, rest.data(), rest.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return;  // the error cannot be reported anywhere
        rest.remove_prefix(static_cast<std::size_t>(count));
    }
}

std::string of_dropped(std::size_t count) {
    return "octoskin-node: " + std::to_string(count) +
           " lines are left out here: the reader did not keep up\n";
}

}  // namespace

LineWriter::LineWriter(int descriptor, Microseconds end_patience)
    : work_(std::make_shared<Work>(descriptor)), end_patience_(end_patience) {
    sigset_t all;
    sigset_t before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);  // the main thread handles signals
    struct Restored {
        const sigset_t& mask;
        ~Restored() { ::pthread_sigmask(SIG_SETMASK, &mask, nullptr); }
    } const restored{before};
    thread_ = std::thread([work = work_] { run(*work); });
}

LineWriter::~LineWriter() {
    std::unique_lock lock(work_->mutex);
    work_->is_ending = true;
    work_->changed.notify_all();
    const bool has_ended = work_->changed.wait_for(lock, end_patience_, [this] { return work_->has_ended; });
    lock.unlock();
    has_ended ? thread_.join() : thread_.detach();
}

void LineWriter::add(std::string line) {
    const std::lock_guard lock(work_->mutex);
    if (work_->lines.size() >= kLinesMax) {
        ++work_->dropped;
        return;
    }
    if (const std::size_t dropped = std::exchange(work_->dropped, 0); dropped > 0)
        work_->lines.push_back(of_dropped(dropped));
    work_->lines.push_back(std::move(line));
    work_->changed.notify_all();
}

void LineWriter::run(Work& work) {
    std::unique_lock lock(work.mutex);
    while (true) {
        work.changed.wait(lock, [&work] { return !work.lines.empty() || work.is_ending; });
        if (work.lines.empty()) break;
        std::string line = std::move(work.lines.front());
        work.lines.pop_front();
        // No further line is queued that could report the dropped lines.
        if (work.lines.empty() && work.dropped > 0) line += of_dropped(std::exchange(work.dropped, 0));
        lock.unlock();
        write_all(work.descriptor, line);
        lock.lock();
    }
    work.has_ended = true;
    work.changed.notify_all();
}

}  // namespace octoskin::linux_port
