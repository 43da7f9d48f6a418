#include "host/bridge/view/daemon_requests.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <iterator>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/unix_socket.hpp"

namespace octoskin::view {

DaemonRequests::DaemonRequests(EventLoop& loop, std::filesystem::path socket)
    : loop_(loop), socket_(std::move(socket)) {}

DaemonRequests::~DaemonRequests() {
    for (Request& request : running_) {
        request.readable = {};
        ::close(request.descriptor);
    }
}

void DaemonRequests::ask(std::string line, Nanoseconds patience, Done done) {
    if (waiting_.size() >= kWaitingMax)
        return done(unexpected(std::string("too many requests wait for the daemon: ask again later")));
    waiting_.push_back({.line = std::move(line) + '\n', .patience = patience, .done = std::move(done)});
    begin_waiting();
}

void DaemonRequests::begin_waiting() {
    while (!waiting_.empty() && running_.size() < kAtOnce) {
        Request request = std::move(waiting_.front());
        waiting_.pop_front();
        begin(std::move(request));
    }
}

void DaemonRequests::begin(Request request) {
    const auto connected = connect_unix_socket(socket_, SOCK_STREAM, std::chrono::milliseconds{1});
    if (!connected) return request.done(unexpected(connected.error().message()));
    request.descriptor = *connected;
    request.end = monotonic_now() + request.patience;
    running_.push_back(std::move(request));
    const auto here = std::prev(running_.end());
    // A new connection has room for a request.
    const ssize_t sent =
        ::send(here->descriptor, here->line.data(), here->line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent != static_cast<ssize_t>(here->line.size()))
        return finish(here, unexpected(std::string("the daemon does not accept the request")));
    here->readable = loop_.on_readable(here->descriptor, [this, here] { read(here); });
}

void DaemonRequests::read(Requests::iterator request) {
    std::array<char, 16384> bytes{};
    const ssize_t count = ::recv(request->descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (count <= 0)
        return finish(request, unexpected(std::string("the daemon closed the connection without an answer")));
    request->answer.append(bytes.data(), static_cast<std::size_t>(count));
    const std::size_t end = request->answer.find('\n');
    if (end != std::string::npos) return finish(request, request->answer.substr(0, end));
    if (request->answer.size() > kAnswerBytesMax)
        finish(request, unexpected(std::string("the daemon's answer exceeds 2 MiB")));
}

void DaemonRequests::finish(Requests::iterator request, Result<std::string, std::string> outcome) {
    request->readable = {};
    ::close(request->descriptor);
    const Done done = std::move(request->done);
    running_.erase(request);
    done(std::move(outcome));
    begin_waiting();
}

void DaemonRequests::attend() {
    const HostTime now = monotonic_now();
    for (auto request = running_.begin(); request != running_.end();) {
        const auto here = request++;
        if (now >= here->end) finish(here, unexpected(std::string("the daemon did not answer in time")));
    }
}

}  // namespace octoskin::view
