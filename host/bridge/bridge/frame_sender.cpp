#include "host/bridge/bridge/frame_sender.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/openni2/frame_pipe.hpp"

namespace octoskin::bridge {
namespace {

constexpr std::chrono::milliseconds kStreamPatience{1'000};
constexpr std::chrono::milliseconds kReconnect{500};
constexpr std::size_t kAnswerMax = 4096;

/// The line of the answer; empty if there is none in time.
std::string read_line(int connection) {
    std::string line;
    char next = 0;
    while (line.size() < kAnswerMax) {
        pollfd readable{connection, POLLIN, 0};
        if (::poll(&readable, 1, static_cast<int>(kStreamPatience.count())) <= 0) return {};
        if (::recv(connection, &next, 1, 0) != 1) return {};
        if (next == '\n') return line;
        line += next;
    }
    return {};
}

/// Empty, or why the daemon does not take this camera's images.
std::string ask_for(int connection, const std::string& camera) {
    const std::string request = camera.empty() ? "camera\n" : "camera " + camera + "\n";
    if (::send(connection, request.data(), request.size(), MSG_NOSIGNAL) !=
        static_cast<ssize_t>(request.size()))
        return "the daemon does not accept the request";
    const std::string answer = read_line(connection);
    if (answer.starts_with(R"({"ok":true)")) return {};
    if (answer.empty()) return "the daemon does not answer";
    const auto refused = nlohmann::json::parse(answer, nullptr, false);
    const bool is_error = refused.is_object() && refused.contains("error") && refused["error"].is_object();
    return "the daemon does not take its images: " +
           (is_error ? refused["error"].value("message", std::string("no reason given")) : "no reason given");
}

}  // namespace

FrameSender::FrameSender(std::filesystem::path control, std::string camera, double rate_hz)
    : control_(std::move(control)), camera_(std::move(camera)), rate_hz_(rate_hz) {
    thread_ = start_without_signals([this] { run(); });
}

FrameSender::~FrameSender() {
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void FrameSender::send(HostTime captured, DepthPixels pixels) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_.push_back({captured, std::move(pixels)});
        if (waiting_.size() > kWaitingMax) {
            waiting_.pop_front();
            ++record_.displaced;
        }
    }
    changed_.notify_all();
}

FrameSenderRecord FrameSender::record() const {
    const std::scoped_lock lock(mutex_);
    return record_;
}

void FrameSender::note(bool is_connected, std::string why) {
    const std::scoped_lock lock(mutex_);
    record_.is_connected = is_connected;
    record_.why = std::move(why);
}

/// False at the end.
bool FrameSender::wait_for_frame() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    return !is_ending_;
}

void FrameSender::wait_before_retry() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kReconnect, [this] { return is_ending_; });
}

void FrameSender::run() {
    while (wait_for_frame()) {
        const auto connection = connect_unix_socket(control_, SOCK_STREAM, kStreamPatience);
        std::string why = connection ? serve(*connection) : connection.error().message();
        if (connection) ::close(*connection);
        note(false, std::move(why));
        wait_before_retry();
    }
}

std::string FrameSender::serve(int connection) {
    if (std::string refused = ask_for(connection, camera_); !refused.empty()) return refused;
    note(true, {});
    std::optional<openni2::FrameSize> size;
    openni2::FramePipe pipe(connection, kStreamPatience);
    while (wait_for_frame()) {
        std::unique_lock lock(mutex_);
        Frame frame = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        if (!size) {
            size = openni2::FrameSize{frame.pixels.width, frame.pixels.height};
            const auto rate_mhz = static_cast<std::uint32_t>(std::lround(rate_hz_ * 1e3));
            if (const auto sent = pipe.write_header({.size = *size, .rate_mhz = rate_mhz}); !sent)
                return std::string("the daemon has ended the connection: ") + openni2::name(sent.error());
        }
        const auto sent =
            pipe.write_frame(static_cast<std::uint64_t>(frame.captured.ns / 1000), frame.pixels.depth_mm);
        if (!sent) return std::string("the daemon has ended the connection: ") + openni2::name(sent.error());
        lock.lock();
        ++record_.sent;
    }
    (void)pipe.write_end();
    return "ending";
}

}  // namespace octoskin::bridge
