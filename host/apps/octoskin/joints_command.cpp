// octoskin joints: joint states from standard input to the daemon, or onto a CAN interface as the rig's joint
// node.
#include <fmt/format.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/joint_socket.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/octoskin/arguments.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::app {
namespace {

struct JointsOptions {
    std::filesystem::path socket = default_joint_socket();
    std::string interface;
    std::filesystem::path rig;
};

/// Where a line's sample goes, and what else the way there asks for.
class JointOutput {
  public:
    virtual ~JointOutput() = default;
    /// Throws CommandFailure if nothing can be sent any more.
    virtual void put(const std::string& line) = 0;
    /// -1, or what to answer when it is readable.
    [[nodiscard]] virtual int descriptor() const { return -1; }
    virtual void answer() {}
};

/// The text as it is: the daemon checks and counts it.
class SocketOutput final : public JointOutput {
  public:
    explicit SocketOutput(const std::filesystem::path& file) : file_(file) {
        const auto connected = connect_unix_socket(file, SOCK_DGRAM);
        if (!connected) throw CommandFailure(connected.error());
        descriptor_ = *connected;
    }
    ~SocketOutput() override { ::close(descriptor_); }
    void put(const std::string& line) override {
        if (::send(descriptor_, line.data(), line.size(), MSG_NOSIGNAL) < 0)
            throw CommandFailure({ExitCode::io_failed, file_.string() + ": the daemon is gone"});
    }

  private:
    std::filesystem::path file_;
    int descriptor_ = -1;
};

/// As a node of the bus: frames, a heartbeat's silence allowed, and an answer to each SYNC.
class CanOutput final : public JointOutput {
  public:
    CanOutput(const JointsOptions& options, const rig::Rig& rig)
        : joint_count_(rig.joints.joints.size()),
          joints_(rig.joints.node_id, joint_count_, rig.joints.rate_hz) {
        constexpr std::array<socketcan::IdFilter, 1> kSyncOnly{
            {{wire::can_id(wire::FrameType::sync, wire::kHostId), wire::kStandardIdMax}}};
        auto opened = socketcan::CanSocket::open(options.interface, {.filters = kSyncOnly});
        if (!opened) throw CommandFailure({ExitCode::unavailable, opened.error().message()});
        socket_.emplace(std::move(opened).value());
    }
    void put(const std::string& line) override {
        const auto sample = parse_joints(line, joint_count_, monotonic_now());
        if (!sample) {
            spdlog::warn("line not sent, {}: {}",
                         names_of(JointTextFault{}).at(static_cast<std::size_t>(sample.error())), line);
            return;
        }
        const auto frames = joints_.frames(sample->sampled, sample->position);
        if (!frames) return;  // parse_joints has refused it already
        for (const wire::CanFrame& frame : *frames) send(frame);
    }
    [[nodiscard]] int descriptor() const override { return socket_->descriptor(); }
    void answer() override {
        while (true) {  // each round takes one frame out of the socket
            const auto received = socket_->receive();
            if (!received) throw CommandFailure({ExitCode::io_failed, received.error().message()});
            if (!received->has_value()) return;
            const auto decoded = wire::decode((*received)->entry.frame);
            const auto* const sync = decoded ? std::get_if<wire::Sync>(&decoded->message) : nullptr;
            const Nanoseconds age{wall_now().ns - (*received)->entry.stamp.ns};
            if (sync != nullptr) send(joints_.report(sync->sequence, monotonic_now() - age));
        }
    }

  private:
    void send(const wire::CanFrame& frame) {
        const auto sent = socket_->send(frame);
        if (!sent && !sent.error().is_down())
            throw CommandFailure({ExitCode::io_failed, sent.error().message()});
    }

    std::size_t joint_count_;
    LocalJoints joints_;
    std::optional<socketcan::CanSocket> socket_;
};

std::unique_ptr<JointOutput> open_output(const JointsOptions& options) {
    if (options.interface.empty()) return std::make_unique<SocketOutput>(options.socket);
    if (options.rig.empty())
        throw CommandFailure(
            {ExitCode::usage, "--can needs --rig: which node sends joint states, and how many"});
    const auto rig = rig::read_rig(options.rig);
    if (!rig) throw CommandFailure({ExitCode::bad_config, rig.error().message()});
    return std::make_unique<CanOutput>(options, *rig);
}

void put_lines(std::string& pending, JointOutput& output) {
    while (true) {  // each round takes one line off
        const std::size_t end = pending.find('\n');
        if (end == std::string::npos) break;
        if (end > 0) output.put(pending.substr(0, end));
        pending.erase(0, end + 1);
    }
    if (pending.size() > kJointTextMax)
        throw CommandFailure(
            {ExitCode::bad_data, fmt::format("standard input: a line of over {} bytes", kJointTextMax)});
}

void forward(const JointsOptions& options) {
    const auto output = open_output(options);
    std::string pending;
    while (true) {  // until standard input ends
        std::array<pollfd, 2> ready{{{STDIN_FILENO, POLLIN, 0}, {output->descriptor(), POLLIN, 0}}};
        ::poll(ready.data(), ready.size(), -1);
        if ((ready[1].revents & POLLIN) != 0) output->answer();
        if (ready[0].revents == 0) continue;
        std::array<char, 4096> bytes{};
        const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count <= 0) break;
        pending.append(bytes.data(), static_cast<std::size_t>(count));
        put_lines(pending, *output);
    }
    if (!pending.empty()) output->put(pending);
}

}  // namespace

void add_joints_command(CLI::App& app) {
    auto options = std::make_shared<JointsOptions>();
    CLI::App* command = app.add_subcommand(
        "joints", "Forward joint states from standard input to the daemon, or onto a CAN bus");
    command->add_option("--socket", options->socket, "Where the daemon takes them (`octoskin run --joints`)")
        ->capture_default_str();
    command->add_option("--can", options->interface,
                        "Send them on this CAN interface instead, as the rig's joint node");
    command->add_option("--rig", options->rig, "Rig (YAML), for --can")->check(existing_file());
    command->footer(
        "One sample a line: [TIME] Q1 ... QN, in the rig's order; radians, metres for a prismatic joint. "
        "TIME is\n"
        "CLOCK_MONOTONIC in seconds; without it a line counts as sampled when it came.");
    command->callback([options] { forward(*options); });
}

}  // namespace octoskin::app
