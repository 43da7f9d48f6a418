#include "host/apps/daemon/control_socket.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "host/apps/daemon/clocks.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"

namespace octoskin {
namespace {

/// The client has closed its side: an answer would not be read.
bool has_gone(int descriptor) {
    pollfd client{descriptor, 0, 0};
    return ::poll(&client, 1, 0) > 0 && (client.revents & (POLLHUP | POLLERR)) != 0;
}

bool has_sent_something(int descriptor) {
    pollfd client{descriptor, POLLIN, 0};
    return ::poll(&client, 1, 0) > 0;
}

/// The process at the other end and its user; 0 and the overflow user if they are not visible.
ucred peer_of(int descriptor) {
    constexpr uid_t kOverflow = 65534;
    ucred peer{};
    socklen_t size = sizeof(peer);
    const bool is_seen = ::getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
    return is_seen ? peer : ucred{0, kOverflow, kOverflow};
}

std::uint64_t descriptor_limit() {
    rlimit limit{};
    return ::getrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}
static_assert(ControlSocket::kWaitingMax == ControlSocket::kClientsMax);
static_assert(ControlSocket::kRefusedMax == ControlSocket::kClientsMax);

/// As by query_refused(), but made without JSON, whose destructors need memory. The error has a code, `what`
/// and a remedy, without characters that JSON escapes.
std::string refusal_line(ExitCode exit, const Error& error) {
    return fmt::format(R"({{"ok":false,"exit":{},"error":{{"code":"{}","remedy":"{}","message":"{}"}}}})",
                       static_cast<int>(exit), name_of(error.code), error.remedy, error.message());
}

}  // namespace

std::size_t ControlSocket::clients_of_each_kind(std::uint64_t descriptors) noexcept {
    constexpr std::uint64_t kKinds = 3;
    const std::uint64_t left = descriptors - std::min<std::uint64_t>(descriptors, kDescriptorsLeft);
    return static_cast<std::size_t>(std::clamp<std::uint64_t>(left / kKinds, 1, kClientsMax));
}

Result<std::unique_ptr<ControlSocket>, AppError> ControlSocket::open(const std::filesystem::path& file,
                                                                     EventLoop& loop, Answer answer,
                                                                     std::chrono::milliseconds idle_max,
                                                                     const std::string& option) {
    auto bound = bind_unix_socket(file, SOCK_STREAM, option);
    if (!bound) return unexpected(bound.error());
    return std::unique_ptr<ControlSocket>(
        new ControlSocket(*std::move(bound), loop, std::move(answer), idle_max));
}

ControlSocket::ControlSocket(BoundSocket bound, EventLoop& loop, Answer answer,
                             std::chrono::milliseconds idle_max)
    : file_(std::move(bound.file)),
      descriptor_(bound.descriptor),
      loop_(loop),
      answer_(std::move(answer)),
      idle_max_(idle_max),
      clients_max_(clients_of_each_kind(descriptor_limit())),
      idle_check_(loop.every(idle_max / 4, [this] { drop_idle(); })) {
    watch();
}

ControlSocket::~ControlSocket() {
    close_clients();
    file_.remove();  // while it still answers, so that no other process has the name yet
    socketcan::close_socket(descriptor_);  // drops what clients sent that were not accepted
}

void ControlSocket::close_clients() {
    acceptable_ = EventSource();
    idle_check_ = EventSource();
    for (const Client& client : clients_) socketcan::close_socket(client.descriptor);
    clients_.clear();
}

void ControlSocket::watch() {
    acceptable_ = loop_.on_readable(descriptor_, [this] { accept(); });
    is_resting_ = false;
}

void ControlSocket::accept() {
    const int descriptor = ::accept4(descriptor_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (descriptor < 0) {
        // A client that cannot be accepted keeps the descriptor readable, which would keep the loop busy.
        is_resting_ = errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM;
        if (!is_resting_) return;
        spdlog::warn("{}: {}: no new client is accepted for a while", file_.path().string(),
                     std::strerror(errno));
        acceptable_ = EventSource();
        return;
    }
    drop_gone();
    const int room = kUnreadMax;
    ::setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &room, sizeof(room));
    Client& client = clients_.emplace_back();
    client.descriptor = descriptor;
    const ucred peer = peer_of(descriptor);
    client.process = peer.pid;
    client.user = peer.uid;
    client.asked = monotonic_now();
    watch(client);
    make_room();
}

/// If there is one client too many, one of them is refused, possibly the new one. If there are too many
/// refused clients, the first of them is dropped.
void ControlSocket::make_room() {
    if (served() > clients_max_) {
        Client* const found = one_to_go();
        refuse(found != nullptr ? *found : clients_.back(), ExitCode::unavailable,
               {.code = ErrorCode::limit_exceeded,
                .what = fmt::format("too many clients: {} are served at once", clients_max_),
                .remedy = "ask again later"});
    }
    const auto refused = std::ranges::count(clients_, true, &Client::is_refused);
    if (std::cmp_greater(refused, clients_max_))
        drop(std::ranges::find(clients_, true, &Client::is_refused)->descriptor);
}

std::size_t ControlSocket::served() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        clients_, [](const Client& client) { return !client.is_refused && client.ticket == 0; }));
}

/// Without the refused clients.
std::size_t ControlSocket::places_of(int process) const {
    return static_cast<std::size_t>(std::ranges::count_if(clients_, [process](const Client& client) {
        return client.process == process && !client.is_refused;
    }));
}

/// Finds a client to drop for the newest one, which is already in the list and about which nothing is known
/// yet. Null: there is none.
ControlSocket::Client* ControlSocket::one_to_go() {
    const std::size_t places_of_new = places_of(clients_.back().process);
    Client* found = nullptr;
    std::pair<std::size_t, bool> found_rank{};
    for (Client& client : clients_) {  // in the order of arrival
        if (&client == &clients_.back()) break;
        // A client whose input is not read yet is about to ask.
        if (client.is_refused || client.ticket != 0 || has_sent_something(client.descriptor)) continue;
        const bool is_half = !client.has_asked || !client.request.empty();
        const std::size_t places = places_of(client.process);
        if (!is_half && places <= places_of_new) continue;
        const std::pair<std::size_t, bool> rank{places, is_half};
        if (found != nullptr && rank <= found_rank) continue;
        found = &client;
        found_rank = rank;
    }
    return found;
}

void ControlSocket::watch(Client& client) {
    client.readable = loop_.on_readable(client.descriptor, [this, &client] {
        if (!serve(client)) drop(client.descriptor);
    });
}

/// Handles one request. The descriptor stays readable while there are more, and the loop returns to it after
/// all others: several requests of one client must not delay the bus.
bool ControlSocket::serve(Client& client) {
    std::array<char, 512> bytes{};
    const ssize_t seen = ::recv(client.descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_PEEK);
    if (seen <= 0) return seen < 0 && (errno == EAGAIN || errno == EINTR);
    const std::string_view here(bytes.data(), static_cast<std::size_t>(seen));
    const std::size_t end = here.find('\n');
    const bool is_whole = end != std::string_view::npos;
    if (!client.is_refused) client.request += here.substr(0, end);
    const std::size_t taken = is_whole ? end + 1 : here.size();
    (void)socketcan::receive_text(client.descriptor, std::span(bytes).first(taken));
    if (client.request.size() > kRequestMax) {
        refuse(client, ExitCode::usage,
               {.code = ErrorCode::limit_exceeded,
                .what = fmt::format("a request has at most {} bytes, and this one has more", kRequestMax),
                .remedy = "ask about parts of it"});
    }
    if (client.is_refused) {
        if (is_whole) socketcan::read_the_rest(client.descriptor);
        return !is_whole;
    }
    if (!is_whole) return true;
    client.asked = monotonic_now();
    client.has_asked = true;
    // A client that has stopped waiting must not start a recording without knowing it.
    if (has_gone(client.descriptor)) return false;
    const std::string request = std::exchange(client.request, {});
    return answer(client, request);
}

/// Sends the refusal at once, because the request may have no end. A client that is still sending would not
/// read the answer if the connection were closed now: it is dropped when its line ends, or when it is idle.
void ControlSocket::refuse(Client& client, ExitCode exit, const Error& error) {
    ++dropped_;
    client.is_refused = true;
    client.request = {};
    (void)send(client, refusal_line(exit, error));
    ::shutdown(client.descriptor, SHUT_WR);
}

bool ControlSocket::answer(Client& client, const std::string& request) {
    if (hand_over_ && hand_over_(request, client.descriptor)) {
        client.descriptor = -1;
        return false;
    }
    if (!later_ || !later_(request, tickets_ + 1, client.user)) return send(client, answer_(request));
    ++tickets_;
    const auto waiting = std::ranges::count_if(clients_, [](const Client& one) { return one.ticket != 0; });
    const auto of_user = std::ranges::count_if(
        clients_, [&](const Client& one) { return one.ticket != 0 && one.user == client.user; });
    const bool are_all_taken = std::cmp_greater_equal(waiting, clients_max_);
    if (are_all_taken || std::cmp_greater_equal(of_user, kWaitingOfUserMax)) {
        gone_(tickets_);
        return send(client, refusal_line(ExitCode::unavailable,
                                         {.code = ErrorCode::limit_exceeded,
                                          .what = fmt::format("too many questions: {} {}wait",
                                                              are_all_taken ? waiting : of_user,
                                                              are_all_taken ? "" : "of this user "),
                                          .remedy = "ask again later"}));
    }
    client.ticket = tickets_;
    client.readable = EventSource();  // the one that calls this now: nothing of it is used after this
    return true;
}

void ControlSocket::reply(std::uint64_t ticket, const std::string& line) {
    const auto client = std::ranges::find(clients_, ticket, &Client::ticket);
    if (ticket == 0 || client == clients_.end()) return;
    client->ticket = 0;
    client->asked = monotonic_now();
    if (!send(*client, line)) return drop(client->descriptor);
    watch(*client);
}

bool ControlSocket::send(const Client& client, std::string line) const {
    line += '\n';
    const ssize_t sent = ::send(client.descriptor, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent == static_cast<ssize_t>(line.size());
}

void ControlSocket::drop(int descriptor) {
    const auto client = std::ranges::find(clients_, descriptor, &Client::descriptor);
    if (client == clients_.end()) return;
    if (client->ticket != 0) gone_(client->ticket);
    clients_.erase(client);  // with its event source, which may call this now
    if (descriptor >= 0) socketcan::close_socket(descriptor);
}

void ControlSocket::drop_gone() {
    std::vector<int> gone;
    for (const Client& client : clients_)
        if (has_gone(client.descriptor)) gone.push_back(client.descriptor);
    for (const int descriptor : gone) drop(descriptor);
}

void ControlSocket::drop_idle() {
    const HostTime now = monotonic_now();
    std::vector<int> idle;
    for (const Client& client : clients_) {
        if (client.ticket != 0 || now - client.asked <= idle_max_) continue;
        idle.push_back(client.descriptor);
        dropped_ += client.is_refused ? 0U : 1U;  // a refused one is counted already
    }
    for (const int descriptor : idle) drop(descriptor);
    drop_gone();
    if (is_resting_) watch();
}

}  // namespace octoskin
