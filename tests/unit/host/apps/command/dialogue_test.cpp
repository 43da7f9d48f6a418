// The whole way of a command: the program's own code on a socket, real node core and driver, modelled
// sensors. What the dialogue says became of it is held against what the node did.
#include "host/apps/command/dialogue.hpp"

#include <gmock/gmock.h>

#include "common/wire/codec.hpp"
#include "common/wire/names.hpp"
#include "tests/support/live/node_on_socket.hpp"

namespace octoskin::commanding {
namespace {

using test::fleet_config;
using test::NodeOnSocket;
using test::SensorSetup;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using wire::CommandCode;

class Commanding : public testing::Test {
  protected:
    explicit Commanding(const std::vector<SensorSetup>& setups = std::vector<SensorSetup>(4),
                        const NodeConfig& config = fleet_config(4, 2))
        : bus_(config, setups) {}

    Order order(CommandCode code, std::uint16_t argument = 0, std::uint8_t sensor = wire::kAllSensors) {
        sequence_ = static_cast<std::uint8_t>(sequence_ + 16);
        Order order{.node_id = 5,
                    .command = {.code = code, .sensor = sensor, .argument = argument, .sequence = sequence_}};
        order.known = Order::Known{
            .name = "ring", .node_hash = node_hash(fleet_config(4, 2)), .sensors = {"a", "b", "c", "d"}};
        return order;
    }
    Dialogue::Outcome outcome_of(const Order& order) {
        Dialogue dialogue(order, bus_.outside().now());
        const auto held = converse(dialogue, bus_.host(), bus_.outside());
        if (!held) return unexpected(held.error());
        return *dialogue.outcome();
    }
    /// What the person reads.
    std::string perform(const Order& order) {
        const auto outcome = outcome_of(order);
        return outcome ? *outcome : "failed: " + outcome.error().message();
    }
    std::string perform(CommandCode code, std::uint16_t argument = 0,
                        std::uint8_t sensor = wire::kAllSensors) {
        return perform(order(code, argument, sensor));
    }
    /// The error of an order that must fail with this exit code.
    Error failure(const Order& order, ExitCode exit) {
        const auto outcome = outcome_of(order);
        EXPECT_FALSE(outcome) << *outcome;
        if (outcome) return {};
        EXPECT_EQ(outcome.error().exit, exit) << outcome.error().message();
        EXPECT_EQ(outcome.error().error.key, order.whom());
        return outcome.error().error;
    }
    void go_safe() {
        for (int i = 0; i < 4; ++i) {
            bus_.rig().reset({.cause = wire::ResetCause::watchdog});
            bus_.rig().run_for(Microseconds{500'000});
        }
        ASSERT_EQ(bus_.rig().node().state(), wire::NodeState::safe);
    }
    std::size_t readings_in_a_second(std::uint8_t sensor) {
        bus_.rig().run_for(Microseconds{100'000});
        const std::size_t before = bus_.rig().readings_of(sensor).size();
        bus_.rig().run_for(Microseconds{1'000'000});
        return bus_.rig().readings_of(sensor).size() - before;
    }

    NodeOnSocket bus_;
    std::uint8_t sequence_ = 0;
};

TEST_F(Commanding, stop_and_start_are_told_once_all_sensors_follow) {
    EXPECT_EQ(perform(CommandCode::stop), "node 5 'ring': stop: stopped; 4 sensors: 4 stopped\n");
    EXPECT_EQ(readings_in_a_second(0), 0U);
    EXPECT_EQ(perform(CommandCode::start), "node 5 'ring': start: ranging; 4 sensors: 4 ranging\n");
    EXPECT_GT(readings_in_a_second(0), 20U);
}

TEST_F(Commanding, one_sensor_stops_alone) {
    EXPECT_THAT(perform(CommandCode::stop, 0, 2),
                HasSubstr("stop: ranging; 4 sensors: 3 ranging, 1 stopped"));
    EXPECT_EQ(readings_in_a_second(2), 0U);
    EXPECT_GT(readings_in_a_second(1), 20U);
    EXPECT_THAT(perform(CommandCode::start, 0, 2), HasSubstr("4 ranging"));
}

TEST_F(Commanding, another_rate_is_in_force_until_it_is_as_configured_again) {
    EXPECT_THAT(perform(CommandCode::set_rate, 200), HasSubstr("set_rate: ranging at another rate;"));
    EXPECT_LE(readings_in_a_second(0), 6U);
    EXPECT_THAT(perform(CommandCode::set_rate, 0),
                AllOf(HasSubstr("set_rate: ranging; "), Not(HasSubstr("another rate"))));
    EXPECT_GT(readings_in_a_second(0), 20U);
    const Error too_fast = failure(order(CommandCode::set_rate, 10), ExitCode::failed);
    EXPECT_EQ(too_fast.code, ErrorCode::out_of_range);
    EXPECT_EQ(too_fast.value, "10 ms");
    EXPECT_THAT(too_fast.what, HasSubstr("refuses set_rate"));
    EXPECT_THAT(too_fast.remedy, HasSubstr("--period-ms"));
}

TEST_F(Commanding, identify_blinks_the_light) {
    const std::size_t before = bus_.rig().lit().size();
    EXPECT_THAT(perform(CommandCode::identify, 10), HasSubstr("node 5 'ring': identify: ranging"));
    bus_.rig().run_for(Microseconds{3'000'000});
    EXPECT_GT(bus_.rig().lit().size(), before + 4);
}

TEST_F(Commanding, reset_is_believed_only_of_a_run_that_began_anew) {
    EXPECT_THAT(perform(CommandCode::reset), HasSubstr("node 5 'ring': reset: "));
    EXPECT_EQ(bus_.rig().said_of<wire::Heartbeat>().back().reset_cause, wire::ResetCause::software);
    const std::size_t heard = bus_.heard().size();
    EXPECT_THAT(perform(CommandCode::reset), HasSubstr("reset: ")) << "in its first seconds, too";
    EXPECT_GT(bus_.heard().size(), heard);
    bus_.ignore_resets();
    const Error no_reset = failure(order(CommandCode::reset), ExitCode::failed);
    EXPECT_EQ(no_reset.code, ErrorCode::no_answer);
    EXPECT_THAT(no_reset.what, HasSubstr("did not refuse reset"));
    EXPECT_THAT(no_reset.value, testing::StartsWith("ranging"));
}

TEST_F(Commanding, send_info_prints_every_page) {
    const std::string text = perform(CommandCode::send_info);
    EXPECT_THAT(text,
                AllOf(HasSubstr("ranging; 4 sensors: 4 ranging\n"), HasSubstr("unique id "),
                      HasSubstr(", as in the rig; up "), HasSubstr("0 I2C errors"), HasSubstr("fault none")));
    Order other = order(CommandCode::send_info);
    other.known->node_hash ^= 0x1'0000U;
    EXPECT_THAT(perform(other), HasSubstr(", not as in the rig;")) << "the upper half counts here";
}

TEST_F(Commanding, send_black_box_is_told_once_the_first_of_it_comes) {
    EXPECT_THAT(perform(CommandCode::send_black_box), HasSubstr("send_black_box: ranging"));
    EXPECT_FALSE(bus_.rig().said_of<wire::BlackBox>().empty());
}

TEST_F(Commanding, a_sensor_that_the_node_has_not_is_never_asked_for) {
    const Error no_sensor = failure(order(CommandCode::stop, 0, 4), ExitCode::usage);
    EXPECT_EQ(no_sensor.code, ErrorCode::unknown_name);
    EXPECT_EQ(no_sensor.value, "4");
    EXPECT_THAT(no_sensor.what, HasSubstr("0 to 3"));
    EXPECT_GT(readings_in_a_second(0), 20U);
}

TEST_F(Commanding, safe_mode_refuses_what_it_must_and_start_ends_it) {
    go_safe();
    const Error safe = failure(order(CommandCode::stop), ExitCode::failed);
    EXPECT_THAT(safe.what, HasSubstr("refuses stop: it takes only start, identify"));
    EXPECT_THAT(safe.remedy, HasSubstr("'start'"));
    EXPECT_THAT(perform(CommandCode::send_info), AllOf(HasSubstr("send_info: safe; "), HasSubstr("fault ")));
    EXPECT_THAT(perform(CommandCode::start), HasSubstr("start: ranging; 4 sensors: 4 ranging"));
}

TEST_F(Commanding, no_heartbeat_and_no_answer_are_two_things) {
    bus_.cut_way_in();
    const Error no_answer = failure(order(CommandCode::stop), ExitCode::unavailable);
    EXPECT_EQ(no_answer.code, ErrorCode::no_answer);
    EXPECT_THAT(no_answer.what, HasSubstr("heartbeats arrive, but no answer"));
    EXPECT_GT(readings_in_a_second(0), 20U);
    bus_.cut_way_out();
    const Error silent = failure(order(CommandCode::stop), ExitCode::unavailable);
    EXPECT_EQ(silent.code, ErrorCode::no_answer);
    EXPECT_THAT(silent.what, HasSubstr("no heartbeat for 2 s"));
    Order stranger = order(CommandCode::stop);
    stranger.node_id = 6;
    EXPECT_THAT(failure(stranger, ExitCode::unavailable).what, HasSubstr("no heartbeat"));
}

TEST_F(Commanding, a_node_that_falls_silent_after_the_command_is_not_said_to_have_followed) {
    Dialogue dialogue(order(CommandCode::stop), bus_.outside().now());
    Outside outside = bus_.outside();
    outside.wait = [this, inner = outside.wait](int descriptor, HostTime until) {
        const auto last =
            bus_.heard().empty()
                ? Result<wire::Decoded, wire::DecodeError>(unexpected(wire::DecodeError::wrong_crc))
                : wire::decode(bus_.heard().back());
        const auto* const command = last ? std::get_if<wire::Command>(&last->message) : nullptr;
        if (command != nullptr && command->code == CommandCode::stop) bus_.cut_way_out();
        inner(descriptor, until);
    };
    ASSERT_TRUE(converse(dialogue, bus_.host(), outside));
    EXPECT_EQ(dialogue.outcome()->error().exit, ExitCode::io_failed);
    EXPECT_EQ(dialogue.outcome()->error().error.code, ErrorCode::no_answer);
    EXPECT_THAT(dialogue.outcome()->error().error.what, HasSubstr("silent since stop"));
}

TEST_F(Commanding, a_sensors_name_counts_only_with_the_rigs_configuration) {
    Order by_name = order(CommandCode::stop, 0, 1);
    by_name.known->node_hash ^= 1U;
    by_name.is_sensor_by_name = true;
    const Error other_rig = failure(by_name, ExitCode::bad_config);
    EXPECT_EQ(other_rig.code, ErrorCode::mismatch);
    EXPECT_THAT(other_rig.what, HasSubstr("its configuration is not that of the rig"));
    EXPECT_TRUE(bus_.heard().empty());
    Order by_number = order(CommandCode::stop, 0, 1);
    by_number.known->node_hash ^= 1U;
    EXPECT_THAT(perform(by_number),
                AllOf(HasSubstr("1 stopped"), HasSubstr("its configuration is not that of the rig")));
}

TEST_F(Commanding, refusals_of_before_are_not_this_commands) {
    for (int i = 0; i < 3; ++i)  // for this node, and wrong: its count is not at zero
        bus_.rig().send_from_host(
            wire::Command{
                .code = CommandCode::stop, .sensor = 40, .sequence = static_cast<std::uint8_t>(200 + i)},
            5);
    bus_.rig().run_for(Microseconds{100'000});
    EXPECT_THAT(perform(CommandCode::stop), HasSubstr("4 stopped"));
}

class CommandingRefused : public Commanding {
  protected:
    static NodeConfig config() {
        NodeConfig config = fleet_config(4, 2);
        config.refuses_commands = true;
        return config;
    }
    CommandingRefused() : Commanding(std::vector<SensorSetup>(4), config()) {}
};

TEST_F(CommandingRefused, the_rigs_key_is_named_whatever_the_command_is) {
    bus_.rig().run_for(Microseconds{3'000'000});
    for (const CommandCode code : {CommandCode::stop, CommandCode::send_info, CommandCode::reset,
                                   CommandCode::identify, CommandCode::set_rate}) {
        EXPECT_THAT(failure(order(code), ExitCode::failed).remedy, HasSubstr("refuses_commands"))
            << wire::name(code);
    }
    EXPECT_EQ(bus_.rig().node().state(), wire::NodeState::ranging);
}

class CommandingWithAbsent : public Commanding {
  protected:
    CommandingWithAbsent() : Commanding(setups()) {}
    static std::vector<SensorSetup> setups() {
        std::vector<SensorSetup> setups(4);
        setups[2].is_fitted = false;
        return setups;
    }
};

TEST_F(CommandingWithAbsent, a_sensor_that_does_not_answer_is_named_and_holds_up_nothing) {
    EXPECT_THAT(perform(CommandCode::reinitialise_sensor),
                HasSubstr("4 sensors: 1 absent (c: no_answer), 3 ranging"));
    EXPECT_THAT(perform(CommandCode::stop),
                HasSubstr("stopped; 4 sensors: 1 absent (c: no_answer), 3 stopped"));
    EXPECT_THAT(perform(CommandCode::start), HasSubstr("3 ranging"));
}

/// A node out of frames made by hand.
class ScriptedNode {
  public:
    explicit ScriptedNode(CommandCode code)
        : dialogue_({.node_id = 9, .command = {.code = code, .sequence = 1}}, HostTime{0}) {}

    void beat(wire::NodeState state = wire::NodeState::ranging) { hear(wire::Heartbeat{.state = state}, 9); }
    void give_pages(std::uint8_t refused, std::uint8_t sensors = 0) {
        for (const wire::NodeInfo& page : std::initializer_list<wire::NodeInfo>{
                 wire::InfoUidLow{}, wire::InfoUidHigh{}, wire::InfoIdentity{.sensor_count = sensors},
                 wire::InfoBuild{.uptime_s = 100}, wire::InfoCounters{},
                 wire::InfoTraffic{.rx_rejected = refused}, wire::InfoFault{}})
            hear(page, 9);
    }
    void hear(const wire::Message& message, wire::NodeId id) {
        dialogue_.on_frame(wire::encode(message, id), now_);
    }
    void pass_ms(std::int64_t ms) {
        now_ = now_ + Nanoseconds{ms * 1'000'000};
        dialogue_.on_time(now_);
    }
    /// What is sent now, if anything is.
    std::optional<wire::Command> take() {
        const auto frame = dialogue_.take_frame();
        if (!frame) return std::nullopt;
        dialogue_.on_sent(now_);
        return std::get<wire::Command>(wire::decode(*frame)->message);
    }
    /// Until the command was sent, and the node is asked again.
    void go_to_asking_after(std::uint8_t refused_before, wire::NodeState state = wire::NodeState::ranging) {
        beat(state);
        EXPECT_EQ(take()->code, CommandCode::send_info);
        give_pages(refused_before);
        EXPECT_NE(take(), std::nullopt);
        pass_ms(100);
        EXPECT_EQ(take()->code, CommandCode::send_info);
        beat(state);
    }
    [[nodiscard]] Error failure() const {
        return dialogue_.outcome() && !*dialogue_.outcome() ? dialogue_.outcome()->error().error : Error{};
    }
    [[nodiscard]] const Dialogue& dialogue() const { return dialogue_; }

  private:
    Dialogue dialogue_;
    HostTime now_{0};
};

TEST(CommandDialogue, believes_no_pages_that_came_before_they_were_asked_for) {
    ScriptedNode node(CommandCode::identify);
    node.give_pages(0);
    EXPECT_EQ(node.take(), std::nullopt) << "no heartbeat yet";
    node.beat();
    EXPECT_EQ(node.take()->code, CommandCode::send_info);
    node.hear(wire::InfoTraffic{}, 9);
    node.hear(wire::InfoBuild{}, 9);
    EXPECT_EQ(node.take(), std::nullopt);
}

TEST(CommandDialogue, never_sends_two_equal_frames_in_a_row) {
    ScriptedNode node(CommandCode::send_info);
    node.beat();
    const auto first = node.take();
    node.pass_ms(299);
    EXPECT_EQ(node.take(), std::nullopt);
    node.pass_ms(1);
    const auto again = node.take();
    ASSERT_TRUE(first && again);
    EXPECT_NE(first->sequence, again->sequence);
    node.give_pages(0);
    const auto command = node.take();
    ASSERT_TRUE(command);
    EXPECT_NE(command->sequence, again->sequence);
}

TEST(CommandDialogue, a_refusal_is_the_counts_growth_and_a_full_count_tells_nothing) {
    ScriptedNode accepted(CommandCode::identify);
    accepted.go_to_asking_after(7);
    accepted.give_pages(7);
    ASSERT_TRUE(accepted.dialogue().outcome());
    EXPECT_TRUE(*accepted.dialogue().outcome());
    ScriptedNode refused(CommandCode::identify);
    refused.go_to_asking_after(7);
    refused.give_pages(8);
    EXPECT_EQ(refused.failure().key, "node 9");
    EXPECT_EQ(refused.failure().code, ErrorCode::unsupported);
    EXPECT_THAT(refused.failure().what, HasSubstr("refuses identify: it has no light"));
    ScriptedNode full(CommandCode::identify);
    full.go_to_asking_after(255);
    full.give_pages(255);
    EXPECT_EQ(full.failure().code, ErrorCode::limit_exceeded);
    EXPECT_EQ(full.failure().value, "255");
    EXPECT_THAT(full.failure().remedy, HasSubstr("'reset'"));
    ScriptedNode unconfigured(CommandCode::stop);
    unconfigured.go_to_asking_after(0, wire::NodeState::bad_config);
    unconfigured.give_pages(1);
    EXPECT_EQ(unconfigured.failure().code, ErrorCode::mismatch);
    EXPECT_THAT(unconfigured.failure().what, HasSubstr("refuses stop: it has no valid configuration"));
    EXPECT_THAT(unconfigured.failure().remedy, HasSubstr("flash"));
}

TEST(CommandDialogue, a_start_that_changes_nothing_says_what_stands_against_it) {
    ScriptedNode node(CommandCode::start);
    node.go_to_asking_after(0, wire::NodeState::id_conflict);
    node.give_pages(0);
    EXPECT_FALSE(node.dialogue().outcome());
    node.pass_ms(4'899);
    EXPECT_FALSE(node.dialogue().outcome());
    node.pass_ms(1);
    EXPECT_EQ(node.failure().code, ErrorCode::duplicate);
    EXPECT_THAT(node.failure().what, HasSubstr("did not refuse start"));
    EXPECT_THAT(node.failure().value, HasSubstr("id_conflict"));
    EXPECT_THAT(node.failure().remedy, HasSubstr("remove one of the two"));
}

// Whatever is said or not: 2 s for a heartbeat, 3 x 0.3 s twice, 0.1 s, 5 s; of a reset some seconds more.
TEST(CommandDialogue, every_wait_ends_whatever_comes) {
    for (const auto& [code, name] : wire::values_of(CommandCode{})) {
        for (int mask = 0; mask < 16; ++mask) {
            ScriptedNode node(code);
            for (int step = 0; step < 400 && !node.dialogue().is_over(); ++step) {
                if ((mask & 1) != 0) node.beat(wire::NodeState::starting);
                if ((mask & 2) != 0 && step > 2) node.give_pages(0, 3);
                if ((mask & 4) != 0) (void)node.take();
                if ((mask & 8) != 0) node.hear(wire::SensorHealth{}, 9);
                node.pass_ms(50);
            }
            EXPECT_TRUE(node.dialogue().is_over()) << name << " " << mask;
        }
    }
}

}  // namespace
}  // namespace octoskin::commanding
