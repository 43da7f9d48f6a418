#include "host/apps/daemon/control_socket.hpp"

#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/unix_socket.hpp"

namespace octoskin {

Result<std::unique_ptr<ControlSocket>, AppError> ControlSocket::open(const std::filesystem::path& file,
                                                                     EventLoop& loop, Answer answer,
                                                                     std::chrono::milliseconds idle_max) {
    const auto descriptor = bind_unix_socket(file, SOCK_STREAM);
    if (!descriptor) return unexpected(descriptor.error());
    return std::unique_ptr<ControlSocket>(
        new ControlSocket(file, *descriptor, loop, std::move(answer), idle_max));
}

ControlSocket::ControlSocket(std::filesystem::path file, int descriptor, EventLoop& loop, Answer answer,
                             std::chrono::milliseconds idle_max)
    : file_(std::move(file)),
      descriptor_(descriptor),
      loop_(loop),
      answer_(std::move(answer)),
      idle_max_(idle_max),
      idle_check_(loop.every(idle_max / 4, [this] { drop_idle(); })) {
    watch();
}

ControlSocket::~ControlSocket() {
    for (const Client& client : clients_) ::close(client.descriptor);
    ::unlink(file_.c_str());  // while it still answers: nobody else has the name yet
    ::close(descriptor_);
}

void ControlSocket::watch() {
    acceptable_ = loop_.on_readable(descriptor_, [this] { accept(); });
    is_resting_ = false;
}

void ControlSocket::accept() {
    const int descriptor = ::accept4(descriptor_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (descriptor < 0) {
        // Whoever cannot be let in stays at the door, which would keep the loop turning.
        is_resting_ = errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM;
        if (!is_resting_) return;
        spdlog::warn("{}: {}: nobody new is let in for a while", file_.string(), std::strerror(errno));
        acceptable_ = EventSource();
        return;
    }
    if (clients_.size() >= kClientsMax) {
        ++dropped_;
        drop(std::ranges::min_element(clients_, {}, &Client::asked)->descriptor);
    }
    const int room = kUnreadMax;
    ::setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &room, sizeof(room));
    Client& client = clients_.emplace_back();
    client.descriptor = descriptor;
    client.asked = monotonic_now();
    client.readable = loop_.on_readable(descriptor, [this, &client] {
        if (!serve(client)) drop(client.descriptor);
    });
}

bool ControlSocket::serve(Client& client) {
    std::array<char, 512> bytes{};
    const ssize_t count = ::recv(client.descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count <= 0) return count < 0 && (errno == EAGAIN || errno == EINTR);
    client.request.append(bytes.data(), static_cast<std::size_t>(count));
    while (true) {  // each round takes one line off
        const std::size_t end = client.request.find('\n');
        if (end == std::string::npos) break;
        const std::string line = client.request.substr(0, end);
        client.request.erase(0, end + 1);
        client.asked = monotonic_now();
        if (!reply(client, answer_(line))) return false;
    }
    const bool is_endless = client.request.size() > kRequestMax;
    dropped_ += is_endless ? 1U : 0U;
    return !is_endless;
}

bool ControlSocket::reply(const Client& client, std::string line) const {
    line += '\n';
    const ssize_t sent = ::send(client.descriptor, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent == static_cast<ssize_t>(line.size());
}

void ControlSocket::drop(int descriptor) {
    // The client's own source is at work just now: it goes with the client.
    clients_.remove_if([descriptor](const Client& client) { return client.descriptor == descriptor; });
    ::close(descriptor);
}

void ControlSocket::drop_idle() {
    const HostTime now = monotonic_now();
    std::vector<int> idle;
    for (const Client& client : clients_)
        if (now - client.asked > idle_max_) idle.push_back(client.descriptor);
    for (const int descriptor : idle) drop(descriptor);
    dropped_ += idle.size();
    if (is_resting_) watch();
}

Result<std::string, AppError> ask_daemon(const std::filesystem::path& socket, const std::string& request) {
    constexpr timeval kPatience{5, 0};  // of each call
    const HostTime end = monotonic_now() + Nanoseconds{5'000'000'000};
    const auto descriptor = connect_unix_socket(socket, SOCK_STREAM);
    if (!descriptor) return unexpected(descriptor.error());
    ::setsockopt(*descriptor, SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof(kPatience));
    ::setsockopt(*descriptor, SOL_SOCKET, SO_SNDTIMEO, &kPatience, sizeof(kPatience));
    const std::string line = request + '\n';
    std::string answer;
    bool is_whole =
        ::send(*descriptor, line.data(), line.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(line.size());
    while (is_whole && !answer.ends_with('\n')) {  // bounded by the end
        std::array<char, 4096> bytes{};
        const ssize_t count = ::recv(*descriptor, bytes.data(), bytes.size(), 0);
        is_whole = count > 0 && monotonic_now() < end;
        if (is_whole) answer.append(bytes.data(), static_cast<std::size_t>(count));
    }
    ::close(*descriptor);
    if (!is_whole) return fail(ExitCode::io_failed, socket.string() + ": the daemon did not answer in 5 s");
    answer.pop_back();
    return answer;
}

}  // namespace octoskin
