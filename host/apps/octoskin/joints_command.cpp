// octoskin joints: joint states from standard input to the daemon, or onto a CAN interface as the rig's joint
// node. The target may come and go: a line that cannot be sent is counted, and the next line is tried again.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "common/wire/codec.hpp"
#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/end_signals.hpp"
#include "host/apps/daemon/can_link.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/joint_socket.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/octoskin/joint_forwarder.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "host/io/urdf/urdf_robot.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::app {
namespace {

constexpr Nanoseconds kRetry{200'000'000};

struct JointsOptions {
    std::filesystem::path socket = default_joint_socket();
    std::string interface;
    std::filesystem::path rig;
};

/// Sends the text unchanged: the daemon checks and counts it, and does not answer.
class SocketOutput final : public JointOutput {
  public:
    explicit SocketOutput(std::filesystem::path file) : file_(std::move(file)) {}
    ~SocketOutput() override { close(); }
    SocketOutput(const SocketOutput&) = delete;
    SocketOutput& operator=(const SocketOutput&) = delete;
    Fate put(const std::string& line, const std::optional<JointLine>& /*parsed*/) override {
        attend();
        if (descriptor_ < 0) return Fate::lost;
        // The kernel keeps ten datagrams. If more come at once, there is room again soon, unless the daemon
        // is stuck. Lines do not wait for a stuck daemon, because that would block their writer.
        pollfd room{descriptor_, POLLOUT, 0};
        const bool is_through = is_sent(line) || (errno == EAGAIN && !is_stuck_ &&
                                                  ::poll(&room, 1, kPatienceMs) == 1 && is_sent(line));
        is_stuck_ = !is_through && errno == EAGAIN;
        if (is_through) return Fate::sent;
        if (is_stuck_) {
            why_ = in_file({ErrorCode::no_answer, "the daemon accepts no samples"}, file_);
        } else {
            close();
            why_ = in_file({ErrorCode::no_listener, "the daemon is gone"}, file_);
        }
        return Fate::lost;
    }
    void attend() override {
        const HostTime now = monotonic_now();
        if (descriptor_ >= 0 || (tried_ && now - *tried_ < kRetry)) return;
        tried_ = now;
        const auto connected = connect_unix_socket(file_, SOCK_DGRAM);
        why_.reset();
        if (connected) {
            descriptor_ = *connected;
        } else {
            why_ = connected.error().error;
        }
    }
    [[nodiscard]] int descriptor() const override { return -1; }
    [[nodiscard]] std::optional<Error> why() const override { return why_; }

  private:
    static constexpr int kPatienceMs = 100;
    [[nodiscard]] bool is_sent(const std::string& line) const {
        return ::send(descriptor_, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0;
    }
    void close() {
        if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
    }
    std::filesystem::path file_;
    int descriptor_ = -1;
    bool is_stuck_ = false;  ///< the daemon, when the newest line came
    std::optional<HostTime> tried_;
    std::optional<Error> why_;
};

/// Acts as the rig's joint nodes on the bus: sends frames, keeps to the heartbeat's silence, and answers each
/// SYNC.
class CanOutput final : public JointOutput {
  public:
    CanOutput(const std::string& interface, const rig::Rig& rig)
        : link_(opener(interface, descriptor_of(interface))) {
        for (const rig::JointSource& source : rig.joint_sources)
            sources_.push_back({LocalJoints(source.node_id, source.joints.size(), source.rate_hz)});
    }
    /// There is a rig, so `parsed` is not empty.
    Fate put(const std::string& /*line*/, const std::optional<JointLine>& parsed) override {
        bool is_any_due = false;
        bool are_through = true;
        for (const JointSample& sample : parsed->samples) {
            Source& source = sources_.at(sample.source);
            const auto frames = source.joints.frames(sample.sampled, sample.position);
            if (!frames) continue;  // too soon after the one before
            is_any_due = source.has_sent = true;
            for (const wire::CanFrame& frame : *frames) are_through = link_.send(frame) && are_through;
        }
        if (!is_any_due) return Fate::thinned;
        return are_through ? Fate::sent : Fate::lost;
    }
    void attend() override {
        (void)link_.attend(monotonic_now());
        constexpr int kDatagramsPerTurn = 256;  // then standard input has its turn
        for (int left = kDatagramsPerTurn; left > 0;) {
            const auto received = link_.receive(left);
            if (!received) return;
            const auto decoded = wire::decode(received->entry.frame);
            const auto* const sync = decoded ? std::get_if<wire::Sync>(&decoded->message) : nullptr;
            const auto ended = monotonic_of(received->entry.stamp);
            if (sync == nullptr || !ended) continue;
            for (const Source& source : sources_)
                if (source.has_sent || sources_.size() == 1)
                    (void)link_.send(source.joints.report(sync->sequence, *ended));
        }
    }
    [[nodiscard]] int descriptor() const override { return link_.descriptor(); }
    [[nodiscard]] std::optional<Error> why() const override {
        if (link_.why().empty()) return std::nullopt;
        return Error{ErrorCode::no_device, link_.why()};
    }

  private:
    static constexpr std::array<socketcan::IdFilter, 1> kSyncOnly{
        {{wire::can_id(wire::FrameType::sync, wire::kHostId), wire::kStandardIdMax}}};
    /// Each time a copy of the descriptor, because the link closes one that failed.
    static CanLink::Opener opener(const std::string& interface, std::optional<int> descriptor) {
        return [interface, descriptor]() -> Result<socketcan::CanSocket, socketcan::SocketFault> {
            if (!descriptor) return socketcan::CanSocket::open(interface, {.filters = kSyncOnly});
            const int copy = ::fcntl(*descriptor, F_DUPFD_CLOEXEC, 0);
            if (copy < 0) return unexpected(socketcan::SocketFault{interface, errno, std::strerror(errno)});
            return socketcan::CanSocket(interface, copy);
        };
    }
    struct Source {
        LocalJoints joints;
        bool has_sent = false;  ///< another program may be the sender of the other sources
    };
    std::vector<Source> sources_;  ///< in the rig's order
    CanLink link_;
};

std::optional<rig::Rig> rig_of(const JointsOptions& options) {
    if (options.rig.empty()) return std::nullopt;
    return value_or_fail(read_given_rig(options.rig));
}

/// To the socket, the sources that the rig has there, or all if it has none there; to a bus, all.
std::optional<RigJoints> joints_of(const JointsOptions& options, const std::optional<rig::Rig>& rig) {
    if (!rig) return std::nullopt;
    const auto robot = read_robot_model(rig->urdf, rig->base_link, rig->joint_names());
    if (!robot) throw CommandFailure(reading_error(ExitCode::bad_config, robot.error()));
    const auto is_of_socket = [](const rig::JointSource& source) {
        return source.way == rig::JointWay::socket;
    };
    const bool takes_all =
        !options.interface.empty() || std::ranges::none_of(rig->joint_sources, is_of_socket);
    HostRig host;
    for (const rig::JointSource& source : rig->joint_sources)
        host.joint_sources.push_back(
            {source.node_id, source.joints, source.rate_hz, takes_all || is_of_socket(source)});
    RigJoints joints{LineJoints::local(host, robot->limits()), {}};
    std::size_t first = 0;
    for (const HostJointSource& source : host.joint_sources) {
        const auto limits = robot->limits().subspan(first, source.joints.size());
        first += source.joints.size();
        if (source.is_local) joints.limits.emplace_back(limits.begin(), limits.end());
    }
    return joints;
}

/// One for each source: several may send at different rates, and lines of one at once with those of another.
/// For lines to the daemon's socket the daemon does this.
std::vector<JointBurst> bursts_of(const JointsOptions& options, const std::optional<RigJoints>& joints) {
    std::vector<JointBurst> bursts;
    if (options.interface.empty()) return bursts;
    for (const LineJoints::Source& source : joints->joints.sources) bursts.emplace_back(source.rate_hz);
    return bursts;
}

std::unique_ptr<JointOutput> make_output(const JointsOptions& options, const std::optional<rig::Rig>& rig) {
    if (options.interface.empty()) return std::make_unique<SocketOutput>(options.socket);
    if (!rig)
        throw CommandFailure(ExitCode::usage,
                             {.code = ErrorCode::bad_argument,
                              .what = "needs the node that sends joint states and the number of joints",
                              .remedy = "give --rig",
                              .key = "--can"});
    return std::make_unique<CanOutput>(options.interface, *rig);
}

void put_lines(std::string& pending, JointForwarder& forwarder) {
    forwarder.begin_block();
    while (true) {  // each round removes one line
        const std::size_t end = pending.find('\n');
        if (end == std::string::npos) break;
        if (end > 0) forwarder.put(pending.substr(0, end));
        pending.erase(0, end + 1);
    }
    forwarder.send_due();
    if (pending.size() > kJointTextMax)
        throw CommandFailure(
            ExitCode::bad_data,
            in_file({ErrorCode::too_large, fmt::format("expected lines of at most {} bytes", kJointTextMax),
                     "a longer line"},
                    "standard input"));
}

void forward(const JointsOptions& options) {
    constexpr int kAttendMs = 200;
    constexpr int kBurstMs = 2;  // no line marks the end of a burst
    const auto rig = rig_of(options);
    const auto output = make_output(options, rig);
    auto joints = joints_of(options, rig);
    auto bursts = bursts_of(options, joints);
    JointForwarder forwarder(*output, std::move(joints), std::move(bursts));
    const EndSignals signals;
    std::string pending;
    while (true) {  // until standard input ends, or a signal
        output->attend();
        forwarder.send_due();
        std::array<pollfd, 3> ready{{{STDIN_FILENO, POLLIN, 0},
                                     {output->descriptor(), POLLIN, 0},
                                     {signals.descriptor(), POLLIN, 0}}};
        ::poll(ready.data(), ready.size(), forwarder.is_waiting() ? kBurstMs : kAttendMs);
        if (ready[2].revents != 0) return forwarder.finish();  // pending bytes are no whole line
        if (ready[0].revents == 0) continue;
        std::array<char, 4096> bytes{};
        const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (count < 0) {
            throw CommandFailure(
                ExitCode::io_failed,
                in_file({ErrorCode::system_error, fmt::format("cannot be read: {}", std::strerror(errno))},
                        "standard input"));
        }
        if (count == 0) break;
        pending.append(bytes.data(), static_cast<std::size_t>(count));
        put_lines(pending, forwarder);
    }
    forwarder.begin_block();
    if (!pending.empty()) forwarder.put(pending);
    forwarder.finish();
}

}  // namespace

void add_joints_command(CLI::App& app) {
    auto options = std::make_shared<JointsOptions>();
    CLI::App* command = app.add_subcommand(
        "joints", "Forward joint states from standard input to the daemon, or onto a CAN bus");
    auto* const socket = command
                             ->add_option("--socket", options->socket,
                                          "Socket of the daemon for joint states (`octoskin run --joints`)")
                             ->capture_default_str();
    command
        ->add_option("--can", options->interface,
                     "Send them on this CAN interface (fd:N: an open socket that carries frames as one) "
                     "instead, as the rig's joint node")
        ->excludes(socket);
    command
        ->add_option("--rig", options->rig,
                     "Rig (YAML): required for --can; with the socket, lines are checked against it")
        ->check(existing_file());
    command->footer(
        "One sample a line: [TIME] Q1 ... QN, numbers separated by blanks or commas, in the rig's order; "
        "radians, metres\nfor a prismatic joint, within +-8.388607. Or by name, in any order: [TIME] "
        "shoulder=0.1 elbow=-0.7. Of a source of the\nrig a line has all joints or none; names that the rig "
        "does not have are left out. TIME is CLOCK_MONOTONIC of this machine "
        "in seconds (as Python's\ntime.monotonic()), within 1 s of now; without it the time of arrival "
        "counts. With --rig a line\nwith another number of joints, or over 0.005 beyond the robot's joint "
        "limits, is refused here; without it\nthe daemon checks the lines, and `octoskin monitor` counts "
        "those "
        "that it refuses.\nAt the end of the input, and on SIGINT or SIGTERM, it prints how many lines were "
        "sent, lost and refused,\nand with --can thinned: newer ones of the same joints came at once, or the "
        "rig's rate is lower.\nExit codes: 0 lines were sent; 64 command line; 65 a line without end; 66 no "
        "such rig file;\n69 no line was sent; 74 standard input cannot be read; 78 the rig is not valid.");
    command->callback([options] { forward(*options); });
}

}  // namespace octoskin::app
