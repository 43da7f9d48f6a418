// `octoskin command` as a person calls it: what is typed wrongly, what is not there, and a simulated node
// that answers over a socket in real time.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include <atomic>
#include <thread>

#include "host/io/socketcan/can_socket.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/node_rig.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class NodeCommand : public ProgramTest {
  protected:
    const std::string rig_file_ = source("hw/rigs/bench_one_board.yaml");
};

TEST_F(NodeCommand, answers_64_to_what_is_typed_wrongly_before_it_looks_for_an_interface) {
    for (const std::string arguments :
         {"bench stop --can nope0", "0 stop --can nope0", "1 halt --can nope0", "1 stop", "1 --can nope0",
          "1 set_rate --can nope0", "1 stop --period-ms 50 --can nope0", "1 calibrate_offset --can nope0",
          "1 identify --seconds 1801 --can nope0", "1 reset --sensor 0 --can nope0",
          "1 start --sensor front --can nope0", "1 start --can fd:99"}) {
        EXPECT_THAT(failure_of("command " + arguments), fails_with(64)) << arguments;
    }
    EXPECT_THAT(
        failure_of("command x stop --can nope0 --rig " + rig_file_),
        fails_with(64, code_is(ErrorCode::unknown_name), value_is("'x'"), remedy_is(HasSubstr("bench (1)"))));
    EXPECT_EQ(octoskin("command 1 stop --can nope0 --rig " + path("nope.yaml")).exit_code, 66);
}

TEST_F(NodeCommand, answers_69_and_names_the_interface_that_is_not_there) {
    EXPECT_THAT(failure_of("command bench stop --can nope0 --rig " + rig_file_),
                fails_with(69, code_is(ErrorCode::no_device), path_is("nope0")));
}

/// The bench's board in real time at the other end of a socket, which a program inherits.
class LiveNode {
  public:
    explicit LiveNode(const NodeConfig& config)
        : rig_(config, std::vector<test::SensorSetup>(4), {}, {}, config.board_type) {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends.data()), 0);
        host_ = ends[0];
        node_.emplace("node", ends[1]);
        rig_.run_for(Microseconds{4'000'000});
        thread_ = std::thread([this] { play(); });
    }
    ~LiveNode() {
        is_ending_ = true;
        thread_.join();
        ::close(host_);
    }
    LiveNode(const LiveNode&) = delete;
    LiveNode& operator=(const LiveNode&) = delete;
    [[nodiscard]] std::string interface() const { return "fd:" + std::to_string(host_); }

  private:
    void play() {
        while (!is_ending_) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            for (auto received = node_->receive(); received && *received; received = node_->receive())
                rig_.send_from_host((*received)->entry.frame);
            const std::size_t before = rig_.frames().size();
            rig_.run_for(Microseconds{2'000});
            if (rig_.node().is_reset_requested()) rig_.reset({.cause = wire::ResetCause::software});
            for (std::size_t i = before; i < rig_.frames().size(); ++i) (void)node_->send(rig_.frames()[i]);
        }
    }
    test::NodeRig rig_;
    int host_ = -1;
    std::optional<socketcan::CanSocket> node_;
    std::atomic<bool> is_ending_ = false;
    std::thread thread_;
};

TEST_F(NodeCommand, does_and_tells_each_of_them) {
    const auto bench = rig::read_rig(rig_file_);
    ASSERT_TRUE(bench);
    LiveNode node(bench->nodes[0].config);
    const auto command = [&](const std::string& arguments) {
        return octoskin("command " + arguments + " --can " + node.interface());
    };
    const Said stopped = command("bench stop --sensor left --rig " + rig_file_);
    EXPECT_EQ(stopped.exit_code, 0) << stopped.output;
    EXPECT_EQ(stopped.output, "node 1 'bench': stop: ranging; 4 sensors: 3 ranging, 1 stopped\n");
    EXPECT_EQ(command("1 start").output, "node 1: start: ranging; 4 sensors: 4 ranging\n");
    EXPECT_THAT(command("all send_info --rig " + rig_file_).output, HasSubstr(", as in the rig; up "));
    EXPECT_EQ(command("1 identify --seconds 1").exit_code, 0);
    const auto failure = [&](const std::string& arguments) {
        return failure_of("command " + arguments + " --can " + node.interface());
    };
    EXPECT_THAT(failure("1 set_rate --period-ms 1"),
                fails_with(1, key_is(HasSubstr("node 1")), what_is(HasSubstr("it refuses set_rate"))));
    EXPECT_THAT(failure("2 stop"), fails_with(69, code_is(ErrorCode::no_answer), key_is(HasSubstr("node 2")),
                                              what_is(HasSubstr("no heartbeat"))));
    const Said reset = command("1 reset");
    EXPECT_EQ(reset.exit_code, 0) << reset.output;
}

}  // namespace
}  // namespace octoskin
