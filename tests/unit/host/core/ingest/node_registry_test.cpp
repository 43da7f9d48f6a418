#include "host/core/ingest/node_registry.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <type_traits>
#include <utility>

#include "common/wire/crc.hpp"

namespace octoskin {
namespace {

constexpr wire::NodeId kNode = 7;
constexpr std::uint32_t kHash = 0xAABBCCDD;
constexpr std::array<std::uint8_t, 12> kUid = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};

HostTime ms(std::int64_t value) {
    return {value * 1'000'000};
}

HostRig rig() {
    HostRig rig;
    rig.nodes.push_back({.node_id = kNode,
                         .name = "upper ring",
                         .node_hash = kHash,
                         .pinned_build_id = {},
                         .sensors = std::vector<HostSensor>(3)});
    rig.joint_sources = {{.node_id = 9, .joints = {"a"}, .rate_hz = 100.0}};
    return rig;
}

wire::Heartbeat heartbeat(std::uint16_t uid_crc = crc16(kUid),
                          wire::NodeState state = wire::NodeState::ranging) {
    return {.state = state,
            .reset_cause = wire::ResetCause::power_on,
            .is_rate_overridden = false,
            .is_time_suspect = false,
            .degraded_sensors = 0,
            .uid_crc = uid_crc,
            .node_hash_low = 0xCCDD};
}

std::vector<wire::NodeInfo> pages(std::uint32_t hash = kHash, std::uint8_t sensors = 3,
                                  std::uint32_t build = 42) {
    return {wire::InfoUidLow{{1, 2, 3, 4, 5, 6}},
            wire::InfoUidHigh{{7, 8, 9, 10, 11, 12}},
            wire::InfoIdentity{hash, sensors, 1},
            wire::InfoBuild{build, 10},
            wire::InfoCounters{},
            wire::InfoTraffic{},
            wire::InfoFault{}};
}

void identify(NodeRegistry& registry, std::int64_t at_ms, const std::vector<wire::NodeInfo>& info = pages()) {
    EXPECT_EQ(registry.on_heartbeat(kNode, heartbeat(), ms(at_ms)), NodeRegistry::Life::goes_on);
    for (const wire::NodeInfo& page : info) {
        EXPECT_TRUE(registry.on_info(kNode, page, ms(at_ms)));
    }
}

TEST(NodeRegistry, trusts_a_node_only_once_every_page_is_here_whatever_their_order) {
    for (std::size_t missing = 0; missing < 7; ++missing) {
        NodeRegistry registry(rig());
        EXPECT_EQ(registry.verdict(kNode, ms(0)), NodeCondition::absent);
        (void)registry.on_heartbeat(kNode, heartbeat(), ms(0));
        for (std::size_t i = 7; i-- > 0;) {
            EXPECT_EQ(registry.verdict(kNode, ms(0)), NodeCondition::info_incomplete);
            if (i != missing) {
                EXPECT_TRUE(registry.on_info(kNode, pages()[i], ms(0)));
            }
        }
        EXPECT_EQ(registry.verdict(kNode, ms(0)), NodeCondition::info_incomplete) << missing;
        EXPECT_TRUE(registry.on_info(kNode, pages()[missing], ms(0)));
        EXPECT_EQ(registry.verdict(kNode, ms(0)), NodeCondition::usable) << missing;
    }
}

TEST(NodeRegistry, names_what_differs_from_the_rig) {
    const auto mismatch = [](const std::vector<wire::NodeInfo>& info) {
        NodeRegistry registry(rig());
        identify(registry, 0, info);
        EXPECT_EQ(registry.verdict(kNode, ms(0)), NodeCondition::info_mismatch);
        return registry.records().at(kNode).mismatch().value_or(NodeMismatch{}).text();
    };
    EXPECT_EQ(mismatch(pages(0xAABBCCDE)), "node_hash aabbccde, the rig has aabbccdd");
    EXPECT_EQ(mismatch(pages(kHash, 4)), "number of sensors 4, the rig has 3");
    auto other_board = pages();
    other_board[0] = wire::InfoUidLow{{9, 9, 9, 9, 9, 9}};
    EXPECT_NE(mismatch(other_board).find("checksum of the unique id"), std::string::npos);
}

// The verdict is asked for every reading, and so must neither format nor allocate.
static_assert(
    std::is_trivially_copyable_v<NodeMismatch>&& noexcept(std::declval<const NodeRecord&>().mismatch()));

TEST(NodeRegistry, describes_a_node_by_name) {
    NodeRegistry registry(rig());
    EXPECT_EQ(registry.describe(kNode, ms(0)), "node 7 'upper ring': absent");
    identify(registry, 0, pages(0xAABBCCDE));
    EXPECT_EQ(
        registry.describe(kNode, ms(0)),
        "node 7 'upper ring': info_mismatch (node_hash aabbccde, the rig has aabbccdd: flash it with this "
        "rig, `octoskin flash --rig RIG --node 7 --elf IMAGE` (`firmware/flash` of octoskin's sources builds "
        "the "
        "image, too), or start octoskin-node with its new block, `octoskin rig RIG "
        "--node 7 --block FILE`)");
    EXPECT_EQ(registry.describe(kNode, ms(999)), "node 7 'upper ring': lost");
}

TEST(NodeRegistry, refuses_another_configuration_at_its_first_heartbeat) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    wire::Heartbeat other = heartbeat();
    other.node_hash_low = 0x1234;
    (void)registry.on_heartbeat(kNode, other, ms(100));
    EXPECT_EQ(registry.verdict(kNode, ms(100)), NodeCondition::info_mismatch);
    EXPECT_EQ(registry.records().at(kNode).mismatch(),
              (NodeMismatch{"low half of node_hash", 0x1234, 0xCCDD}));
}

TEST(NodeRegistry, refuses_another_build_only_where_the_rig_pins_it) {
    HostRig pinned = rig();
    pinned.nodes[0].pinned_build_id = 43;
    NodeRegistry registry(pinned);
    identify(registry, 0);
    EXPECT_EQ(registry.verdict(kNode, ms(0)), NodeCondition::build_refused);
    EXPECT_EQ(registry.describe(kNode, ms(0)),
              "node 7 'upper ring': build_refused (build_id 42, the rig pins 43)");
    EXPECT_TRUE(registry.on_info(kNode, wire::InfoBuild{43, 10}, ms(0)));
    EXPECT_EQ(registry.verdict(kNode, ms(0)), NodeCondition::usable);
}

TEST(NodeRegistry, declares_a_node_lost_350_ms_after_its_last_heartbeat) {
    NodeRegistry registry(rig());
    identify(registry, 1000);
    EXPECT_EQ(registry.verdict(kNode, ms(1350)), NodeCondition::usable);
    EXPECT_EQ(registry.verdict(kNode, ms(1351)), NodeCondition::lost);
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(1400));
    EXPECT_EQ(registry.verdict(kNode, ms(1400)), NodeCondition::usable) << "the same board is known already";
}

TEST(NodeRegistry, does_not_trust_a_clock_that_the_node_doubts_itself) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    wire::Heartbeat suspect = heartbeat();
    suspect.is_time_suspect = true;
    (void)registry.on_heartbeat(kNode, suspect, ms(100));
    EXPECT_EQ(registry.verdict(kNode, ms(100)), NodeCondition::time_suspect);
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(200));
    EXPECT_EQ(registry.verdict(kNode, ms(200)), NodeCondition::usable);
}

TEST(NodeRegistry, holds_a_doubt_about_the_clock_of_a_joint_source_for_a_second) {
    constexpr wire::NodeId kJoints = 9;
    NodeRegistry registry(rig());
    wire::Heartbeat suspect = heartbeat();
    suspect.is_time_suspect = true;
    const auto beat = [&](const wire::Heartbeat& reported, std::optional<HostTime> now) {
        (void)registry.on_heartbeat(kJoints, reported, now);
        return registry.verdict(kJoints, now);
    };
    EXPECT_EQ(beat(heartbeat(), ms(0)), NodeCondition::usable);
    EXPECT_EQ(beat(suspect, ms(100)), NodeCondition::time_suspect);
    for (std::int64_t t = 100; t < 1'100; t += 100)
        EXPECT_EQ(beat(heartbeat(), ms(t)), NodeCondition::time_suspect) << t;
    EXPECT_EQ(beat(heartbeat(), ms(1'100)), NodeCondition::usable);
    EXPECT_EQ(beat(heartbeat(), ms(500)), NodeCondition::usable) << "the host's clock began anew";
    EXPECT_EQ(beat(suspect, std::nullopt), NodeCondition::time_suspect);
    EXPECT_EQ(beat(heartbeat(), std::nullopt), NodeCondition::time_suspect);
    EXPECT_EQ(beat(heartbeat(), ms(2'000)), NodeCondition::time_suspect) << "from when now is known";
    EXPECT_EQ(beat(heartbeat(), ms(3'000)), NodeCondition::usable);
}

TEST(NodeRegistry, quarantines_two_boards_with_one_id_at_the_second_heartbeat) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    for (std::int64_t t = 50; t <= 1050; t += 100) {
        EXPECT_EQ(registry.on_heartbeat(kNode, heartbeat(0x1111), ms(t)), NodeRegistry::Life::restarted);
        EXPECT_EQ(registry.verdict(kNode, ms(t)), NodeCondition::quarantined);
        EXPECT_EQ(
            registry.describe(kNode, ms(t)),
            "node 7 'upper ring': quarantined (two boards send under this node id: take one off the bus)");
        EXPECT_FALSE(registry.on_info(kNode, pages()[0], ms(t)));
        (void)registry.on_heartbeat(kNode, heartbeat(), ms(t + 50));
        EXPECT_EQ(registry.verdict(kNode, ms(t + 50)), NodeCondition::quarantined);
    }
    // The second board leaves after 1050 ms; the first was heard again at 1100.
    for (std::int64_t t = 1200; t <= 3000; t += 100) {
        (void)registry.on_heartbeat(kNode, heartbeat(), ms(t));
        EXPECT_EQ(registry.verdict(kNode, ms(t)), NodeCondition::quarantined);
    }
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(3100));
    EXPECT_EQ(registry.verdict(kNode, ms(3100)), NodeCondition::info_incomplete)
        << "who it is must be told anew";
    identify(registry, 3200);
    EXPECT_EQ(registry.verdict(kNode, ms(3200)), NodeCondition::usable);
}

/// Ranges at 30 Hz of three sensors, a frame every `every_ms` from `from_ms` on, up to and without `to_ms`.
NodeCondition speak(NodeRegistry& registry, std::int64_t from_ms, std::int64_t to_ms, std::int64_t every_ms) {
    for (std::int64_t t = from_ms; t < to_ms; t += every_ms) registry.on_frame(kNode, ms(t));
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(to_ms - 1));
    return registry.verdict(kNode, ms(to_ms - 1));
}

TEST(NodeRegistry, refuses_a_node_that_babbles_until_a_second_after_it_kept_to_its_frames) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    // 18 + 3 * 32 frames a second, twice, and 8: 236. One every 9 ms is well within that.
    EXPECT_EQ(speak(registry, 0, 5'000, 9), NodeCondition::usable);
    for (int i = 0; i < 236; ++i) registry.on_frame(kNode, ms(7'000));
    EXPECT_EQ(speak(registry, 7'999, 8'000, 1), NodeCondition::babbling) << "the 237th";
    EXPECT_EQ(registry.describe(kNode, ms(8'000)),
              "node 7 'upper ring': babbling (over 236 frames within a second, twice the rig's rate for "
              "it: refused until a second after it stays below that)");
    EXPECT_FALSE(registry.on_info(kNode, pages()[0], ms(8'000)));
    EXPECT_EQ(speak(registry, 8'001, 8'999, 9), NodeCondition::babbling);
    EXPECT_EQ(speak(registry, 8'999, 9'001, 9), NodeCondition::usable) << "who it is was known before";
    EXPECT_TRUE(registry.on_info(kNode, pages()[0], ms(9'000)));
}

TEST(NodeRegistry, refuses_a_babbling_node_as_long_as_it_babbles) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    EXPECT_EQ(speak(registry, 0, 1'000, 1), NodeCondition::babbling);
    for (std::int64_t t = 1'000; t < 60'000; t += 100) {
        EXPECT_EQ(speak(registry, t, t + 100, 3), NodeCondition::babbling) << t;
    }
}

TEST(NodeRegistry, does_not_release_a_babbling_node_while_no_time_is_known) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    EXPECT_EQ(speak(registry, 0, 1'000, 1), NodeCondition::babbling);
    EXPECT_EQ(registry.verdict(kNode, std::nullopt), NodeCondition::babbling);
    registry.on_frame(kNode, ms(3'000));
    EXPECT_NE(registry.verdict(kNode, std::nullopt), NodeCondition::babbling) << "it was released before";
}

TEST(NodeRegistry, quarantines_an_id_under_which_two_send_readings) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    std::int64_t reported_ms = 0;
    for (std::int64_t t = 0; t < 1'000 && reported_ms == 0; t += 33) {
        const auto number = static_cast<std::uint8_t>(t / 33);
        for (std::uint8_t sensor = 0; sensor < 3; ++sensor) {
            for (const unsigned from : {0U, 21U}) {
                wire::RangeReading reading{};
                reading.sensor = sensor;
                reading.sequence = static_cast<std::uint8_t>((number + from) % wire::kSequenceCount);
                registry.on_reading(kNode, reading, ms(t));
            }
        }
        (void)registry.on_heartbeat(kNode, heartbeat(), ms(t));
        reported_ms = registry.verdict(kNode, ms(t)) == NodeCondition::quarantined ? t : 0;
    }
    EXPECT_NEAR(static_cast<double>(reported_ms), 33 * 17, 50) << "half of 93 readings, and three";
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(reported_ms + 1'999));
    EXPECT_EQ(registry.verdict(kNode, ms(reported_ms + 1'999)), NodeCondition::quarantined);
    EXPECT_EQ(registry.verdict(kNode, ms(reported_ms + 2'000)), NodeCondition::info_incomplete)
        << "who it is must be told anew";
}

TEST(NodeRegistry, ends_every_refusal_when_the_host_s_clock_begins_anew) {
    constexpr std::int64_t kHourMs = 3'600'000;
    NodeRegistry registry(rig());
    for (int i = 0; i < 300; ++i) registry.on_frame(kNode, ms(kHourMs));
    (void)registry.on_heartbeat(kNode, heartbeat(0x1111), ms(kHourMs));
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(kHourMs));
    registry.on_other_version(kNode, 2, ms(kHourMs));
    identify(registry, 100);
    EXPECT_EQ(registry.verdict(kNode, ms(100)), NodeCondition::usable);
}

TEST(NodeRegistry, takes_a_board_that_replaces_a_lost_one_but_asks_it_who_it_is) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    EXPECT_EQ(registry.on_heartbeat(kNode, heartbeat(0x1111), ms(1000)), NodeRegistry::Life::restarted);
    EXPECT_EQ(registry.verdict(kNode, ms(1000)), NodeCondition::info_incomplete);
}

TEST(NodeRegistry, notices_a_restart) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    const auto starting = heartbeat(crc16(kUid), wire::NodeState::starting);
    EXPECT_EQ(registry.on_heartbeat(kNode, starting, ms(100)), NodeRegistry::Life::restarted);
    EXPECT_EQ(registry.on_heartbeat(kNode, starting, ms(200)), NodeRegistry::Life::goes_on);
    EXPECT_EQ(registry.verdict(kNode, ms(200)), NodeCondition::info_incomplete);
}

TEST(NodeRegistry, refuses_a_node_of_another_version_until_it_is_silent_for_a_second) {
    NodeRegistry registry(rig());
    identify(registry, 0);
    registry.on_other_version(kNode, 2, ms(100));
    EXPECT_EQ(registry.verdict(kNode, ms(100)), NodeCondition::other_version);
    EXPECT_EQ(registry.describe(kNode, ms(100)),
              "node 7 'upper ring': other_version (version 2, this host uses 1)");
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(1000));
    EXPECT_FALSE(registry.on_info(kNode, pages()[0], ms(1000)));
    EXPECT_EQ(registry.verdict(kNode, ms(1099)), NodeCondition::other_version);
    EXPECT_EQ(registry.verdict(kNode, ms(1100)), NodeCondition::info_incomplete);
}

TEST(NodeRegistry, holds_a_refusal_while_no_time_is_known) {
    NodeRegistry registry(rig());
    registry.on_other_version(kNode, 2, std::nullopt);
    EXPECT_EQ(registry.verdict(kNode, std::nullopt), NodeCondition::other_version);
    EXPECT_EQ(registry.verdict(kNode, ms(99'999)), NodeCondition::other_version) << "nobody knows since when";
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(100'000));
    EXPECT_EQ(registry.verdict(kNode, ms(100'999)), NodeCondition::other_version);
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(101'000));
    EXPECT_EQ(registry.verdict(kNode, ms(101'000)), NodeCondition::info_incomplete);
}

TEST(NodeRegistry, counts_who_was_heard_while_no_time_was_known_as_heard_when_it_is_known) {
    NodeRegistry registry(rig());
    identify(registry, 1000);
    (void)registry.on_heartbeat(kNode, heartbeat(), std::nullopt);
    EXPECT_EQ(registry.verdict(kNode, ms(61'000)), NodeCondition::lost);
    registry.on_time_known(ms(61'000));  // another host's, a minute ahead
    EXPECT_EQ(registry.verdict(kNode, ms(61'350)), NodeCondition::usable);
    EXPECT_EQ(registry.verdict(kNode, ms(61'351)), NodeCondition::lost);
    // Not heard since then: it stays lost.
    registry.on_time_known(ms(62'000));
    EXPECT_EQ(registry.verdict(kNode, ms(62'000)), NodeCondition::lost);
    (void)registry.on_heartbeat(kNode, heartbeat(), std::nullopt);
    (void)registry.on_heartbeat(kNode, heartbeat(), ms(63'000));
    registry.on_time_known(ms(64'000));
    EXPECT_EQ(registry.verdict(kNode, ms(64'000)), NodeCondition::lost) << "heard at a time that is known";
}

TEST(NodeRegistry, calls_a_node_lost_that_is_silent_while_others_speak_and_nobody_tells_the_time) {
    using std::chrono::milliseconds;
    NodeRegistry registry(rig());
    EXPECT_EQ(registry.verdict(kNode, std::nullopt), NodeCondition::absent);
    registry.on_running(milliseconds(5'000));
    (void)registry.on_heartbeat(kNode, heartbeat(), std::nullopt);
    registry.on_running(milliseconds(5'350));
    EXPECT_EQ(registry.verdict(kNode, std::nullopt), NodeCondition::info_incomplete);
    registry.on_running(milliseconds(5'351));
    EXPECT_EQ(registry.verdict(kNode, std::nullopt), NodeCondition::lost);
    // Who takes its place is none that shares its id.
    EXPECT_EQ(registry.on_heartbeat(kNode, heartbeat(0x1111), std::nullopt), NodeRegistry::Life::restarted);
    EXPECT_EQ(registry.verdict(kNode, std::nullopt), NodeCondition::info_incomplete);
    // The time is known 300 ms later: it was heard 300 ms ago, not now.
    registry.on_running(milliseconds(5'651));
    registry.on_time_known(ms(61'000));
    EXPECT_EQ(registry.verdict(kNode, ms(61'050)), NodeCondition::info_incomplete);
    EXPECT_EQ(registry.verdict(kNode, ms(61'051)), NodeCondition::lost);
}

TEST(NodeRegistry, quarantines_two_boards_even_while_no_time_is_known) {
    NodeRegistry registry(rig());
    (void)registry.on_heartbeat(kNode, heartbeat(), std::nullopt);
    (void)registry.on_heartbeat(kNode, heartbeat(0x1111), std::nullopt);
    EXPECT_EQ(registry.verdict(kNode, std::nullopt), NodeCondition::quarantined);
    for (std::int64_t t = 5000; t < 7000; t += 100) {  // the time is known, and only one board is left
        (void)registry.on_heartbeat(kNode, heartbeat(0x1111), ms(t));
        EXPECT_EQ(registry.verdict(kNode, ms(t)), NodeCondition::quarantined);
    }
    (void)registry.on_heartbeat(kNode, heartbeat(0x1111), ms(7000));
    EXPECT_EQ(registry.verdict(kNode, ms(7000)), NodeCondition::info_incomplete);
}

TEST(NodeRegistry, asks_no_block_of_the_node_that_sends_joints_only) {
    NodeRegistry registry(rig());
    ASSERT_TRUE(registry.knows(9));
    EXPECT_EQ(registry.verdict(9, ms(0)), NodeCondition::absent);
    (void)registry.on_heartbeat(9, heartbeat(), ms(0));
    EXPECT_EQ(registry.verdict(9, ms(0)), NodeCondition::usable);
    EXPECT_FALSE(registry.knows(8));
}

}  // namespace
}  // namespace octoskin
