#include "host/apps/daemon/register_log.hpp"

#include <gmock/gmock.h>

namespace octoskin {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RegisterLogTest : public testing::Test {
  protected:
    static HostRig rig() {
        HostRig rig;
        rig.nodes.push_back({.node_id = 3, .name = "ring", .pinned_build_id = {}, .sensors = {HostSensor{}}});
        rig.joint_sources = {{.node_id = 19, .joints = {"a"}, .rate_hz = 100.0}};
        return rig;
    }
    void say(wire::FaultKind kind, const wire::RegisterReport& report) {
        EXPECT_TRUE(nodes_.on_info(3, wire::InfoFault{.kind = kind, .where = report.where()}, HostTime{1}));
    }
    NodeRegistry nodes_{rig()};
    RegisterLog log_;
};

TEST_F(RegisterLogTest, has_each_register_and_value_once) {
    EXPECT_THAT(log_.news(nodes_), IsEmpty());
    say(wire::FaultKind::register_alike, {3, 0x47, 0x0B, 0x0C});
    EXPECT_THAT(log_.news(nodes_), ElementsAre(AllOf(HasSubstr("node 3 'ring'"), HasSubstr("0x47"),
                                                     HasSubstr("0x0B"), HasSubstr("0x0C"))));
    say(wire::FaultKind::register_alike, {5, 0x47, 0x0B, 0x0C});
    EXPECT_THAT(log_.news(nodes_), IsEmpty());
    say(wire::FaultKind::register_alike, {3, 0x47, 0x0B, 0x0D});
    EXPECT_EQ(log_.news(nodes_).size(), 1U);
}

TEST_F(RegisterLogTest, leaves_to_the_problems_what_is_one) {
    say(wire::FaultKind::register_fixed, {0, 0x47, 0x0B, 0x0C});
    EXPECT_THAT(log_.news(nodes_), IsEmpty());
}

TEST_F(RegisterLogTest, ends_where_a_node_that_starts_over_and_over_reads_otherwise_each_time) {
    std::size_t lines = 0;
    for (unsigned run = 0; run < 20; ++run) {
        const auto beat = [&](wire::NodeState state) {
            (void)nodes_.on_heartbeat(3, {.state = state}, HostTime{1'000'000'000LL * run});
        };
        beat(wire::NodeState::ranging);
        beat(wire::NodeState::starting);
        for (unsigned read = 0; read < 32; ++read)
            say(wire::FaultKind::register_alike,
                {3, static_cast<std::uint8_t>(run), 0, static_cast<std::uint8_t>(read)});
        lines += log_.news(nodes_).size();
    }
    EXPECT_EQ(lines, 256U);
}

}  // namespace
}  // namespace octoskin
