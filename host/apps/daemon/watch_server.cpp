#include "host/apps/daemon/watch_server.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <new>
#include <sstream>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"

namespace octoskin {
namespace {

constexpr const char* kGreeting = "{\"ok\":true,\"watch\":1}\n";
constexpr const char* kRequest = "watch";

std::uint8_t bit_of(watch::FrameKind kind) noexcept {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(kind));
}

std::uint8_t bits_of(const WatchWants& wants) noexcept {
    std::uint8_t bits = 0;
    for (const auto kind : {watch::FrameKind::map, watch::FrameKind::range, watch::FrameKind::joints,
                            watch::FrameKind::status, watch::FrameKind::image, watch::FrameKind::robot})
        if (wants.has(kind)) bits |= bit_of(kind);
    return bits;
}

WatchEvent reload_event(std::uint64_t reloads) {
    return {watch::FrameKind::reload, HostTime{0},
            std::make_shared<const std::string>(watch::reload_payload(reloads))};
}

}  // namespace

/// A watcher with its connection.
struct WatchServer::Client {
    Client(int connection_in, const WatchWants& wants)
        : connection(connection_in), output(wants, kGreeting), moved(monotonic_now()) {}
    ~Client() { socketcan::close_socket(connection); }
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    int connection;
    Watcher output;
    HostTime moved;        ///< when it last took something, or lacked nothing
    bool is_full = false;  ///< its connection took not all
};

WatchServer::WatchServer(const HostRig& rig, Nanoseconds stalled_max)
    : stalled_max_(stalled_max),
      joint_counts_(rig.joint_counts()),
      thread_(start_without_signals([this] { run(); })) {}

WatchServer::~WatchServer() {
    end();
}

void WatchServer::end() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    wake_.wake();
    thread_.join();
    given_ = {};
    wanted_ = 0;
}

bool WatchServer::is_request(const std::string& line) {
    return line == kRequest || line.starts_with(std::string(kRequest) + ' ');
}

std::optional<WatchWants> WatchServer::parse(const std::string& line) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    WatchWants wants;
    bool has_any = false;
    while (words >> word) {
        has_any = true;
        bool* const wanted = word == "map"      ? &wants.map
                             : word == "ranges" ? &wants.ranges
                             : word == "joints" ? &wants.joints
                             : word == "status" ? &wants.status
                             : word == "images" ? &wants.images
                             : word == "robot"  ? &wants.robot
                                                : nullptr;
        if (wanted == nullptr) return std::nullopt;
        *wanted = true;
    }
    return has_any ? wants : WatchWants{true, true, true, true};
}

bool WatchServer::take(int connection, const WatchWants& wants) {
    {
        const std::lock_guard lock(mutex_);
        if (is_ending_ || watchers_ >= kWatchersMax) return false;
        given_.clients.reserve(given_.clients.size() + 1);  // a client closes its connection
        given_.clients.push_back(std::make_unique<Client>(connection, wants));
        ++watchers_;
        wanted_ |= bits_of(wants);
    }
    wake_.wake();
    return true;
}

bool WatchServer::wants(watch::FrameKind kind) const noexcept {
    return (wanted_ & bit_of(kind)) != 0;
}

void WatchServer::give_map(FusedMap copy, HostTime time) {
    std::optional<MapNow> before;  // released without the lock
    {
        const std::lock_guard lock(mutex_);
        before = std::exchange(given_.map, MapNow{std::move(copy), time});
    }
    wake_.wake();
}

void WatchServer::give_status(std::string json) {
    give(watch::FrameKind::status, HostTime{0}, std::move(json));
}

void WatchServer::give_robot(const std::string& urdf) {
    give(watch::FrameKind::robot, HostTime{0}, urdf.size() <= watch::kPayloadMax ? urdf : std::string());
}

void WatchServer::on_sample(const JointMeasurement& joints) noexcept try {
    if (wants(watch::FrameKind::joints))
        give(watch::FrameKind::joints, joints.sampled,
             watch::joints_payload(joints, joint_counts_.at(joints.source)));
} catch (const std::bad_alloc&) {
    ++lost_;
}

void WatchServer::on_beam(const Beam& beam) noexcept try {
    if (wants(watch::FrameKind::range))
        give(watch::FrameKind::range, beam.captured, watch::range_payload(beam));
} catch (const std::bad_alloc&) {
    ++lost_;
}

void WatchServer::on_image(const DepthFrame& frame) noexcept try {
    if (!wants(watch::FrameKind::image)) return;
    if (!images_.takes(frame.camera, frame.captured)) return;
    give(watch::FrameKind::image, frame.captured, watch::image_payload(frame));
} catch (const std::bad_alloc&) {
    ++lost_;
}

void WatchServer::give(watch::FrameKind kind, HostTime time, std::string payload) {
    auto shared = std::make_shared<const std::string>(std::move(payload));
    {
        const std::lock_guard lock(mutex_);
        put({kind, time, std::move(shared)});
    }
    wake_.wake();
}

/// Under the mutex. Beyond the limit there is of each lasting kind the newest event.
void WatchServer::put(WatchEvent event) {
    std::vector<WatchEvent>& events = given_.events;
    if (events.size() >= kEventsMax) {
        if (!watch::is_lasting(event.kind)) {
            ++lost_;
            return;
        }
        const auto first = events.begin() + static_cast<std::ptrdiff_t>(kEventsMax);
        events.erase(std::remove_if(first, events.end(),
                                    [&](const WatchEvent& other) { return other.kind == event.kind; }),
                     events.end());
    }
    events.push_back(std::move(event));
}

void WatchServer::change_rig(const HostRig& rig, std::uint64_t reloads) {
    joint_counts_ = rig.joint_counts();
    WatchEvent reload = reload_event(reloads);
    std::optional<MapNow> before;  // released without the lock
    {
        const std::lock_guard lock(mutex_);
        before = std::exchange(given_.map, std::nullopt);
        given_.reloads = reloads;
        put(std::move(reload));
    }
    wake_.wake();
}

WatchServer::Record WatchServer::record() const {
    return {watchers_, stalled_, lost_};
}

void WatchServer::run() {
    constexpr int kNicer = 15;  // a watcher that is late gets fewer maps, an image that is late is lost
    yield_to_the_loop(kNicer);
    while (!is_ending_) {
        wait_for_work();
        wake_.clear();
        try {
            spread(taken());
            serve();
        } catch (const std::bad_alloc&) {  // the map and the bus have the memory first
            clients_.clear();
            map_.reset();
        }
        count_watchers();
    }
    clients_.clear();
    map_.reset();
}

void WatchServer::wait_for_work() {
    std::vector<pollfd> waiting{{wake_.descriptor(), POLLIN, 0}};
    for (const auto& client : clients_)
        waiting.push_back({client->connection, static_cast<short>(client->is_full ? POLLOUT : 0), 0});
    constexpr int kLook_ms = 1'000;  // for watchers that have gone or have stalled
    (void)::poll(waiting.data(), waiting.size(), kLook_ms);
}

WatchServer::Given WatchServer::taken() {
    const std::lock_guard lock(mutex_);
    Given taken = std::exchange(given_, {});
    given_.reloads = taken.reloads;
    return taken;
}

/// A client begins after the events: those before a reload would follow the frame that it begins with.
void WatchServer::spread(Given given) {
    for (const WatchEvent& event : given.events) spread(event);
    for (auto& client : given.clients) welcome(std::move(client), given.reloads);
    if (given.map) spread(std::move(*given.map));
}

void WatchServer::spread(const WatchEvent& event) {
    if (event.kind == watch::FrameKind::reload) is_map_old_ = true;
    if (event.kind == watch::FrameKind::robot) robot_ = event;
    for (const auto& client : clients_) client->output.on_event(event);
}

void WatchServer::welcome(std::unique_ptr<Client> client, std::uint64_t reloads) {
    client->output.on_event(reload_event(reloads));
    if (robot_) client->output.on_event(*robot_);
    if (map_ && !is_map_old_) client->output.on_map(*map_, {});
    clients_.push_back(std::move(client));
}

void WatchServer::spread(MapNow map) {
    const watch::BrickCodes changed = map_ ? watch::changed_bricks(map.map, map_->map) : watch::BrickCodes{};
    map_ = std::move(map);
    const auto readers =
        std::ranges::count_if(clients_, [](const auto& client) { return client->output.wants().map; });
    if (readers > 1) map_->changed = watch::BrickRecords(map_->map, changed);
    is_map_old_ = false;
    for (const auto& client : clients_) client->output.on_map(*map_, changed);
}

void WatchServer::serve() {
    const HostTime now = monotonic_now();
    std::erase_if(clients_, [&](const auto& client) { return !serve(*client, now); });
    if (clients_.empty()) map_.reset();
}

/// False if the client has gone or has stalled.
bool WatchServer::serve(Client& client, HostTime now) {
    constexpr int kChunksAtOnce = 4;  // then the others have their turn
    pollfd look{client.connection, 0, 0};
    if (::poll(&look, 1, 0) > 0 && (look.revents & (POLLHUP | POLLERR)) != 0) return false;
    client.is_full = true;
    for (int i = 0; i < kChunksAtOnce; ++i) {
        const std::string_view bytes = client.output.pending(map_ ? &*map_ : nullptr);
        if (bytes.empty()) {
            client.is_full = false;
            client.moved = now;
            return true;
        }
        const ssize_t sent =
            ::send(client.connection, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent < 0 && errno != EAGAIN && errno != EINTR) return false;
        if (sent <= 0) break;
        client.output.on_sent(static_cast<std::size_t>(sent));
        client.moved = now;
    }
    if (now - client.moved <= stalled_max_) return true;
    ++stalled_;
    return false;
}

void WatchServer::count_watchers() {
    const std::lock_guard lock(mutex_);
    std::uint8_t wanted = 0;
    for (const auto* list : {&clients_, &given_.clients})
        for (const auto& client : *list) wanted |= bits_of(client->output.wants());
    wanted_ = wanted;
    watchers_ = clients_.size() + given_.clients.size();
}

}  // namespace octoskin
