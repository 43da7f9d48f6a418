#include "host/bridge/bridge/daemon_link.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "host/apps/command_line/json_at.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/unix_socket.hpp"

namespace octoskin::bridge {
namespace {

using Json = nlohmann::ordered_json;

/// Between two attempts, after one that failed.
constexpr Nanoseconds kRest{2'000'000'000};
constexpr std::string_view kGreeting = R"({"ok":true,"watch":1})";
/// Read in one turn of the loop: others get their turn.
constexpr int kReadsPerTurn = 32;

Unexpected<std::string> malformed() {
    return unexpected(std::string("a frame of 'watch' is malformed"));
}

}  // namespace

DaemonLink::DaemonLink(EventLoop& loop, std::filesystem::path socket, DaemonListener& listener, Wishes wishes)
    : loop_(loop),
      socket_(std::move(socket)),
      listener_(listener),
      request_(std::move(wishes.request) + '\n'),
      patience_(wishes.patience) {}

DaemonLink::~DaemonLink() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void DaemonLink::attend() {
    const HostTime now = monotonic_now();
    if (descriptor_ >= 0 || (tried_ && now - *tried_ < rest_)) return;
    tried_ = now;
    rest_ = Nanoseconds{0};  // a daemon that is not there is refused at once
    connect();
    const bool was_slow = monotonic_now() - now >= patience_;
    if (descriptor_ < 0 && was_slow) rest_ = kRest;
}

void DaemonLink::connect() {
    const auto connected = connect_unix_socket(socket_, SOCK_STREAM, patience_);
    if (!connected) return listener_.on_lost(connected.error().message());
    descriptor_ = *connected;
    if (const auto described = describe(); !described) return lose(described.error());
    if (::send(descriptor_, request_.data(), request_.size(), MSG_NOSIGNAL | MSG_DONTWAIT) !=
        static_cast<ssize_t>(request_.size()))
        return lose("the daemon does not accept the request");
    bytes_.clear();
    is_greeted_ = false;
    map_ = watch::WatchedMap();
    reloads_.reset();
    readable_ = loop_.on_readable(descriptor_, [this] { read(); });
}

Status<std::string> DaemonLink::describe() {
    const auto answer = ask_daemon(socket_, "describe", patience_);
    if (!answer) return unexpected(answer.error().message());
    const Json described = Json::parse(*answer, nullptr, false);
    auto facts = robot_facts(described);
    if (!facts)
        return unexpected("the daemon has another version: its answer to 'describe' is not understood (" +
                          facts.error() + "): install the same version of both, and restart them");
    described_ = facts->reloads;
    listener_.on_described(described);
    listener_.on_robot(std::move(facts).value());
    return Done{};
}

void DaemonLink::read() {
    std::array<char, 65'536> room{};
    for (int i = 0; i < kReadsPerTurn; ++i) {
        const ssize_t count = ::recv(descriptor_, room.data(), room.size(), MSG_DONTWAIT);
        if (count < 0 && (errno == EAGAIN || errno == EINTR)) break;
        if (count <= 0) return lose("the daemon has closed the connection");
        bytes_.append(room.data(), static_cast<std::size_t>(count));
    }
    if (const auto taken = take_frames(); !taken) lose(taken.error());
}

Status<std::string> DaemonLink::take_frames() {
    std::string_view left = bytes_;
    if (!is_greeted_) {
        const std::size_t end = left.find('\n');
        if (end == std::string_view::npos) return Done{};
        if (left.substr(0, end) != kGreeting)
            return unexpected("the daemon refuses: " + std::string(left.substr(0, end)));
        is_greeted_ = true;
        left.remove_prefix(end + 1);
    }
    while (left.size() >= watch::kHeaderBytes) {
        const auto header = watch::parse_header(left);
        if (!header) return unexpected(std::string("the daemon sends another version of 'watch'"));
        if (left.size() < watch::kHeaderBytes + header->bytes) break;
        if (const auto taken = take(*header, left.substr(watch::kHeaderBytes, header->bytes)); !taken)
            return taken;
        left.remove_prefix(watch::kHeaderBytes + header->bytes);
    }
    bytes_.erase(0, bytes_.size() - left.size());
    return Done{};
}

Status<std::string> DaemonLink::take(const watch::FrameHeader& header, std::string_view payload) {
    lost_ = header.lost;
    if (!reloads_ && header.kind != watch::FrameKind::reload) return malformed();
    switch (header.kind) {
        case watch::FrameKind::map:
            return take_map(header, payload);
        case watch::FrameKind::range:
            return take_range(header, payload);
        case watch::FrameKind::joints:
            return take_joints(header, payload);
        case watch::FrameKind::status:
            return take_status(payload);
        case watch::FrameKind::image:
            return take_image(header, payload);
        case watch::FrameKind::robot:
            listener_.on_urdf(std::string(payload));
            return Done{};
        case watch::FrameKind::reload:
            return take_reload(payload);
    }
    return malformed();
}

/// What follows is placed with the rig that it was made with: the listener has it before the next frame.
Status<std::string> DaemonLink::take_reload(std::string_view payload) {
    reloads_ = watch::parse_reload(payload);
    if (!reloads_) return malformed();
    if (*reloads_ > described_)
        if (auto described = describe(); !described) return described;
    if (*reloads_ <= described_) return Done{};
    return unexpected(std::string("the daemon describes a rig that it does not have any more"));
}

/// The daemon reloads again while a frame waits here: then the description is newer than the frame.
bool DaemonLink::is_current() {
    if (*reloads_ == described_) return true;
    ++outdated_;
    return false;
}

/// The map itself goes on across a reload.
Status<std::string> DaemonLink::take_map(const watch::FrameHeader& header, std::string_view payload) {
    if (map_.take(header, payload) != watch::WatchedMap::Taken::all)
        return unexpected(std::string("the map is malformed, or larger than 2 GiB"));
    if (map_.is_complete() && is_current()) listener_.on_map(map_);
    return Done{};
}

Status<std::string> DaemonLink::take_range(const watch::FrameHeader& header, std::string_view payload) {
    const auto range = watch::parse_range(payload);
    if (!range) return malformed();
    if (is_current()) listener_.on_range(*range, header.time);
    return Done{};
}

Status<std::string> DaemonLink::take_joints(const watch::FrameHeader& header, std::string_view payload) {
    const auto joints = watch::parse_joints(payload);
    if (!joints) return malformed();
    if (is_current()) listener_.on_joints(*joints, header.time);
    return Done{};
}

Status<std::string> DaemonLink::take_image(const watch::FrameHeader& header, std::string_view payload) {
    const auto image = watch::parse_image(payload);
    if (!image) return malformed();
    if (is_current()) listener_.on_image(*image, header.time);
    return Done{};
}

Status<std::string> DaemonLink::take_status(std::string_view payload) {
    const Json status = is_nested_too_deep(payload) ? Json() : Json::parse(payload, nullptr, false);
    if (!at(status, "problems").is_array())
        return unexpected(std::string("the daemon's status is malformed"));
    if (is_current()) listener_.on_status(status);
    return Done{};
}

void DaemonLink::lose(const std::string& why) {
    readable_ = {};
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
    listener_.on_lost(why);
}

}  // namespace octoskin::bridge
