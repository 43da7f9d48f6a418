// Somebody sends readings under a sensor's name, beside its node: nothing of them is in the map but what one
// reading marked before the first contradiction, it is named within a second, and nobody else loses anything.
// The forged frames do not reach the node itself: else it falls silent (C11), which can_test shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/codec.hpp"
#include "tests/sim/reliability/attacked_bus.hpp"

namespace octoskin::test {
namespace {

constexpr AttackedBus::SensorKey kAttacked{kFirst, 0};
constexpr double kAttack_s = 4.5;
constexpr std::int64_t kAttackUs = 4'500'000;

wire::RangeReading forged(wire::RangeReading reading, std::uint16_t range_mm) {
    reading.range_mm = range_mm;
    return reading;
}
/// `steps` numbers and so much time later, or earlier.
wire::RangeReading moved(wire::RangeReading reading, int steps, std::int64_t later_us) {
    reading.sequence = static_cast<std::uint8_t>((reading.sequence + steps + 64) % 64);
    reading.capture = wire::classical_residue(NodeTime{reading.capture.value_us} + Microseconds{later_us});
    return reading;
}

struct Said {
    wire::NodeId node = 0;
    wire::RangeReading reading;
    std::int64_t arrives_us = 0;
    unsigned count = 0;  ///< of those of its sensor since the attack began, from 0
};
using Forge = std::function<void(const Said&, std::vector<OnTheWay>&)>;

/// The attacker hears each reading of these sensors and sends what `forge` makes of it, from kAttack_s on.
Reader attack_on(std::vector<AttackedBus::SensorKey> sensors, const Forge& forge) {
    auto counts = std::make_shared<std::map<AttackedBus::SensorKey, unsigned>>();
    return [=](wire::NodeId node, const wire::RangeReading& reading, std::int64_t arrives_us,
               std::vector<OnTheWay>& way) {
        way.push_back({arrives_us, range_frame(node, reading)});
        const AttackedBus::SensorKey key{node, reading.sensor};
        if (arrives_us < kAttackUs || std::ranges::find(sensors, key) == sensors.end()) return;
        forge({node, reading, arrives_us, (*counts)[key]++}, way);
    };
}

void put(const Said& said, const wire::RangeReading& reading, std::int64_t delay_us,
         std::vector<OnTheWay>& way) {
    way.push_back({said.arrives_us + delay_us, range_frame(said.node, reading)});
}
/// Some tenths of a millisecond before the reading that it is made of: the attacker knows when that comes.
void before(const Said& said, const wire::RangeReading& reading, std::vector<OnTheWay>& way) {
    put(said, reading, -300, way);
}

struct Scenario {
    std::string name;
    Forge forge;
    std::vector<AttackedBus::SensorKey> sensors = {kAttacked};
    BusSetup setup = {};
    bool is_named = true;
};

void PrintTo(const Scenario& scenario, std::ostream* out) {
    *out << scenario.name;
}

std::vector<AttackedBus::SensorKey> all_of(const BusSetup& setup) {
    std::vector<AttackedBus::SensorKey> all;
    for (std::uint8_t sensor = 0; sensor < setup.sensors; ++sensor) all.emplace_back(kFirst, sensor);
    return all;
}

BusSetup slow(std::uint16_t period_ms) {
    return {.budget_ms = 20, .period_ms = period_ms};
}

/// A whole second stream, with numbers `apart` from the node's and half a period later.
Forge second_stream(int apart) {
    return [apart](const Said& said, std::vector<OnTheWay>& way) {
        put(said, forged(moved(said.reading, apart, 10'000), 200), 10'000, way);
    };
}

std::vector<Scenario> scenarios() {
    const auto each = [](std::uint16_t range_mm) {
        return [range_mm](const Said& said, std::vector<OnTheWay>& way) {
            before(said, forged(said.reading, range_mm), way);
        };
    };
    const Forge half = [](const Said& said, std::vector<OnTheWay>& way) {
        if (said.count % 2 == 0) before(said, forged(said.reading, 200), way);
    };
    const Forge after = [](const Said& said, std::vector<OnTheWay>& way) {
        put(said, forged(said.reading, 200), 2'000, way);
    };
    const Forge alternate = [](const Said& said, std::vector<OnTheWay>& way) {
        put(said, forged(said.reading, said.count % 4 < 2 ? 200 : 1'300), said.count % 2 == 0 ? -300 : 700,
            way);
    };
    const Forge fresh = [](const Said& said, std::vector<OnTheWay>& way) {  // the next number, ahead of it
        put(said, forged(moved(said.reading, 1, 13'000), 200), 13'000, way);
    };
    const Forge fresh_of_slow = [](const Said& said, std::vector<OnTheWay>& way) {
        for (const std::int64_t later_us : {18'000, 36'000, 130'000})
            put(said, forged(moved(said.reading, 1, later_us), 200), later_us, way);
    };
    const Forge rare_fresh_of_slow = [](const Said& said, std::vector<OnTheWay>& way) {
        if (said.count % 8 == 0) put(said, forged(moved(said.reading, 1, 130'000), 200), 130'000, way);
    };
    const Forge older = [](const Said& said, std::vector<OnTheWay>& way) {
        put(said, forged(moved(said.reading, -3, -60'000), 200), 500, way);
    };
    const Forge zone = [](const Said& said, std::vector<OnTheWay>& way) {
        wire::RangeReading other = forged(said.reading, 200);
        other.zone = 1;
        before(said, other, way);
    };
    const Forge rare = [](const Said& said, std::vector<OnTheWay>& way) {  // every 1.5 s
        if (said.count % 75 == 0) before(said, forged(said.reading, 200), way);
    };
    const Forge twice = [](const Said& said, std::vector<OnTheWay>& way) {
        before(said, forged(said.reading, 200), way);
        before(said, forged(said.reading, 1'300), way);
    };
    std::vector<Scenario> all = {
        {"all_near", each(200)},
        {"all_far", each(1'300)},
        {"half", half},
        {"each_after_the_true_one", after},
        {"by_turns_before_and_after", alternate},
        {"fresh_numbers", fresh},
        {"fresh_numbers_of_a_sensor_at_4_hz", fresh_of_slow, {kAttacked}, slow(250)},
        {"one_fresh_number_in_two_seconds_at_4_hz", rare_fresh_of_slow, {kAttacked}, slow(250), false},
        {"numbers_that_were_here", older},
        {"another_zone", zone},
        {"two_for_each", twice},
        {"one_in_one_and_a_half_seconds", rare, {kAttacked}, {.run_s = 20.0}, false},
        {"all_sensors", each(200), all_of({})},
        {"all_sensors_far", each(1'300), all_of({})},
        {"eight_of_seventeen", each(200), {}, {.sensors = 17, .budget_ms = 20, .period_ms = 33}},
    };
    for (std::uint8_t sensor = 0; sensor < 8; ++sensor) all.back().sensors.emplace_back(kFirst, sensor);
    for (const int apart : {1, 2, 20, 32, 33, 40, 63})
        all.push_back({"a_stream_" + std::to_string(apart) + "_apart", second_stream(apart)});
    for (Scenario& scenario : all) scenario.setup.nodes = 2;
    return all;
}

class SecondSender : public testing::TestWithParam<std::tuple<Scenario, Release>> {};

void expect_others_whole(const AttackedBus& bus, const std::vector<AttackedBus::SensorKey>& attacked) {
    for (const auto& [sensor, count] : bus.counts()) {
        if (std::ranges::find(attacked, sensor) != attacked.end()) continue;
        EXPECT_GE(count.share(), 0.99) << int{sensor.first} << '.' << int{sensor.second};
        EXPECT_FALSE(bus.named_s(sensor)) << int{sensor.first} << '.' << int{sensor.second};
    }
}

TEST_P(SecondSender, marks_one_reading_at_most_is_named_and_costs_nobody_else_anything) {
    const auto& [scenario, release] = GetParam();
    BusSetup setup = scenario.setup;
    setup.release = release;
    const AttackedBus clean(setup);
    setup.on_reading = attack_on(scenario.sensors, scenario.forge);
    const AttackedBus bus(setup);
    EXPECT_EQ(clean.untrue(), 0U);
    EXPECT_LE(bus.untrue(), 1U) << bus.pipeline().inputs_text();
    EXPECT_EQ(bus.wrong_voxels(clean), 0U);
    EXPECT_TRUE(bus.replayed_map() == bus.map());
    expect_others_whole(clean, {});
    expect_others_whole(bus, scenario.sensors);
    EXPECT_FALSE(bus.losing_s().contains(kOther));
    if (HasFailure()) std::printf("%s", bus.pipeline().inputs_text().c_str());
    for (const auto& sensor : scenario.sensors) {
        const auto named_s = bus.named_s(sensor);
        const bool is_node_refused = bus.refused().contains(sensor.first);
        if (scenario.is_named && !is_node_refused) {
            ASSERT_TRUE(named_s) << int{sensor.second};
        }
        if (named_s) {
            EXPECT_LE(*named_s, kAttack_s + 1.0 + 1e-3 * scenario.setup.period_ms) << int{sensor.second};
        }
    }
}

std::string scenario_name(const testing::TestParamInfo<std::tuple<Scenario, Release>>& given) {
    const bool is_live = std::get<1>(given.param) == Release::once_placed;
    return std::get<0>(given.param).name + (is_live ? "_live" : "_replayed");
}
INSTANTIATE_TEST_SUITE_P(Each, SecondSender,
                         testing::Combine(testing::ValuesIn(scenarios()),
                                          testing::Values(Release::once_placed, Release::by_capture_time)),
                         scenario_name);

/// The newest of what the attacked node told about itself.
struct Heard {
    std::optional<wire::Heartbeat> heartbeat;
    std::map<std::size_t, wire::NodeInfo> pages;
    std::optional<wire::SensorHealth> health;  ///< of the attacked sensor

    void note(const wire::Decoded& said) {
        if (said.node_id != kAttacked.first) return;
        if (const auto* reported = std::get_if<wire::Heartbeat>(&said.message)) heartbeat = *reported;
        if (const auto* page = std::get_if<wire::NodeInfo>(&said.message)) pages[page->index()] = *page;
        const auto* reported = std::get_if<wire::SensorHealth>(&said.message);
        if (reported != nullptr && reported->sensor == kAttacked.second) health = *reported;
    }
};

/// A frame in the node's name that has its readings refused, and the one that has them count again.
struct Switch {
    std::string name;
    std::function<std::pair<wire::Message, wire::Message>(const Heard&)> make;
    bool is_of_node = true;  ///< else of the attacked sensor alone
};
void PrintTo(const Switch& off, std::ostream* out) {
    *out << off.name;
}

Switch by_page(const std::string& name, wire::InfoPage page, void (*alter)(wire::NodeInfo&)) {
    return {name, [=](const Heard& heard) -> std::pair<wire::Message, wire::Message> {
                const wire::NodeInfo own = heard.pages.at(static_cast<std::size_t>(page));
                wire::NodeInfo other = own;
                alter(other);
                return {other, own};
            }};
}

std::vector<Switch> switches() {
    const auto by_heartbeat = [](const std::string& name, void (*alter)(wire::Heartbeat&)) {
        return Switch{name, [=](const Heard& heard) -> std::pair<wire::Message, wire::Message> {
                          wire::Heartbeat other = heard.heartbeat.value();
                          alter(other);
                          return {other, *heard.heartbeat};
                      }};
    };
    const auto by_bound = [](const Heard& heard) -> std::pair<wire::Message, wire::Message> {
        wire::SensorHealth other = heard.health.value();
        other.capture_bound_64us = 255;
        return {other, *heard.health};
    };
    return {
        {"capture_bound", by_bound},
        by_heartbeat("is_time_suspect", [](wire::Heartbeat& reported) { reported.is_time_suspect = true; }),
        by_heartbeat("node_hash_low", [](wire::Heartbeat& reported) { reported.node_hash_low ^= 1U; }),
        by_page(
            "node_hash", wire::InfoPage::identity,
            [](wire::NodeInfo& reported) { std::get<wire::InfoIdentity>(reported).node_hash ^= 1U << 31U; }),
        by_page("unique_id", wire::InfoPage::uid_low,
                [](wire::NodeInfo& reported) { std::get<wire::InfoUidLow>(reported).uid[0] ^= 1U; })};
}

class SwitchedOff : public testing::TestWithParam<std::tuple<Switch, Release>> {};

/// The attacker has each reading of the sensor refused, or every second one if not `is_each`, and sends its
/// own under the same number afterwards. While a sensor is switched off its node's readings are refused for
/// 40 us, so that the others' lose nothing.
BusSetup with_switch(const Switch& off, bool is_each, bool is_mine_sent = true) {
    BusSetup setup{.nodes = 2};
    auto heard = std::make_shared<Heard>();
    setup.on_other = [=](const wire::Decoded& said) { heard->note(said); };
    setup.on_reading = attack_on({kAttacked}, [=](const Said& said, std::vector<OnTheWay>& way) {
        if (!is_each && said.count % 2 != 0) return;
        const auto [refusing, own] = off.make(*heard);
        way.push_back({said.arrives_us - 20, wire::encode(refusing, said.node)});
        way.push_back({said.arrives_us + 20, wire::encode(own, said.node)});
        if (is_mine_sent) put(said, forged(moved(said.reading, 0, 8'000), 200), 9'000, way);
    });
    return setup;
}

TEST_P(SwitchedOff, a_sensor_s_own_readings_leave_no_room_for_another_s) {
    const auto& [off, release] = GetParam();
    for (const bool is_each : {true, false}) {
        const AttackedBus clean({.nodes = 2, .release = release});
        BusSetup setup = with_switch(off, is_each);
        setup.release = release;
        const AttackedBus bus(setup);
        EXPECT_EQ(bus.untrue(), 0U) << bus.pipeline().inputs_text();
        EXPECT_EQ(bus.wrong_voxels(clean), 0U);
        EXPECT_TRUE(bus.replayed_map() == bus.map());
        expect_others_whole(bus, {kAttacked});
        ASSERT_TRUE(bus.named_s(kAttacked));
        EXPECT_LE(*bus.named_s(kAttacked), kAttack_s + 1.0);
        EXPECT_GE(bus.pipeline().intake().ranges().senders(kFirst, 0).contradictions(), 2U);
    }
}

std::string switch_name(const testing::TestParamInfo<std::tuple<Switch, Release>>& given) {
    const bool is_live = std::get<1>(given.param) == Release::once_placed;
    return std::get<0>(given.param).name + (is_live ? "_live" : "_replayed");
}
INSTANTIATE_TEST_SUITE_P(Each, SwitchedOff,
                         testing::Combine(testing::ValuesIn(switches()),
                                          testing::Values(Release::once_placed, Release::by_capture_time)),
                         switch_name);

TEST(SwitchedOff, a_node_is_named_for_what_goes_back_and_forth) {
    for (const Switch& off : switches()) {
        if (off.name == "unique_id") continue;  // the losses name it
        SCOPED_TRACE(off.name);
        const AttackedBus bus(with_switch(off, true, false));
        ASSERT_TRUE(bus.named_words().contains(kFirst));
        EXPECT_LE(bus.named_words().at(kFirst), kAttack_s + 1.0);
        EXPECT_FALSE(bus.named_words().contains(kOther));
    }
}

TEST(SwitchedOff, readings_of_a_node_that_is_usable_again_are_named_with_their_reason) {
    for (const Switch& off : switches()) {
        if (off.name == "capture_bound") continue;  // of one sensor: its node may tell that
        SCOPED_TRACE(off.name);
        const AttackedBus bus(with_switch(off, true, false));
        EXPECT_EQ(bus.untrue(), 0U);
        ASSERT_TRUE(bus.losing_s().contains(kFirst));
        EXPECT_LE(bus.losing_s().at(kFirst), kAttack_s + 1.0);
        EXPECT_EQ(bus.losses().at(kFirst).most, off.name == "is_time_suspect"
                                                    ? ReadingReason::node_time_suspect
                                                    : ReadingReason::node_info_mismatch);
        EXPECT_FALSE(bus.losing_s().contains(kOther));
        EXPECT_TRUE(bus.named().empty());
    }
}

/// Of an attacker's readings with impossible times, the three kinds by turns.
wire::RangeReading impossible(const wire::RangeReading& reading, unsigned kind) {
    const int steps = kind % 3 == 0 ? 1 : kind % 3 == 1 ? 1 : 20;
    const std::int64_t later_us = kind % 3 == 0 ? 8'000 : kind % 3 == 1 ? 4'000 : -45'000;
    return forged(moved(reading, steps, later_us), 200);
}

struct Rate {
    unsigned per_s = 0;
    Release release = Release::once_placed;
};
AttackedBus with_impossible_times(const Rate& rate) {
    BusSetup setup{.nodes = 2, .release = rate.release, .run_s = 15.0};
    auto sent = std::make_shared<unsigned>(0);
    setup.on_reading = attack_on({kAttacked}, [=](const Said& said, std::vector<OnTheWay>& way) {
        const auto due = static_cast<unsigned>((said.arrives_us - kAttackUs) * rate.per_s / 1'000'000);
        if (rate.per_s == 0 || due < *sent) return;
        const wire::RangeReading reading = impossible(said.reading, (*sent)++);
        put(said, reading, 200, way);  // right behind the true one: before its window can have ended
    });
    return AttackedBus(setup);
}

TEST(ImpossibleTimes, of_one_sensor_cost_nobody_anything) {
    const AttackedBus clean = with_impossible_times({});
    std::printf("%-12s%12s%16s%8s%8s%12s\n", "forged/s", "own used", "others, worst", "SYNCs", "strays",
                "named after");
    for (const Release release : {Release::once_placed, Release::by_capture_time}) {
        for (const unsigned per_s : {0U, 1U, 2U, 5U}) {
            const AttackedBus bus = with_impossible_times({per_s, release});
            double worst = 1.0;
            for (const auto& [sensor, count] : bus.counts())
                worst = sensor == kAttacked ? worst : std::min(worst, count.share());
            const double own = bus.counts().at(kAttacked).share();
            std::printf(
                "%-12u%10.2f %%%14.2f %%%8llu%8llu%10.2f s\n", per_s, 100.0 * own, 100.0 * worst,
                static_cast<unsigned long long>(bus.syncs()),
                static_cast<unsigned long long>(bus.pipeline().intake().ranges().senders(kFirst, 0).strays()),
                bus.named_s(kAttacked).value_or(kAttack_s) - kAttack_s);
            EXPECT_EQ(bus.untrue(), 0U);
            EXPECT_EQ(bus.wrong_voxels(clean), 0U);
            EXPECT_GE(worst, 0.99) << per_s;
            EXPECT_GE(own, 0.95) << per_s;
            EXPECT_EQ(bus.named_s(kAttacked).has_value(), per_s > 0);
            EXPECT_LE(bus.named_s(kAttacked).value_or(0.0), kAttack_s + 0.1) << "at the first of them";
            EXPECT_EQ(bus.named().size(), per_s > 0 ? 1U : 0U);
            EXPECT_EQ(bus.pipeline().intake().clock(kFirst).relocks(), 0U);
        }
    }
}

TEST(ImpossibleTimes, of_all_sensors_of_a_node_cost_nobody_anything) {
    BusSetup setup{.nodes = 2, .run_s = 12.0};
    setup.on_reading = attack_on(all_of(setup), [](const Said& said, std::vector<OnTheWay>& way) {
        if (said.count % 25 == 0) put(said, impossible(said.reading, said.count / 25), 200, way);
    });
    const AttackedBus bus(setup);
    EXPECT_EQ(bus.untrue(), 0U);
    for (const auto& [sensor, count] : bus.counts()) EXPECT_GE(count.share(), 0.99) << int{sensor.second};
}

TEST(ClockJumps, of_a_node_place_no_reading_wrong_and_are_over_after_two_exchanges) {
    for (const std::int64_t jump_ms : {-3'000, -240, -120, -60, -30, -18, 15, 30, 60, 120, 240, 3'000}) {
        for (const double at_s : {5.05, 5.5, 5.93}) {
            SCOPED_TRACE(std::to_string(jump_ms) + " ms at " + std::to_string(at_s));
            BusSetup setup{.nodes = 2, .budget_ms = 20, .period_ms = 33, .run_s = 11.0};
            setup.clock_jumps_at_s = at_s;
            setup.clock_jump_us = 1'000 * jump_ms;
            const AttackedBus bus(setup);
            EXPECT_EQ(bus.untrue(), 0U) << bus.pipeline().inputs_text();
            EXPECT_EQ(bus.pipeline().intake().clock(kFirst).relocks(), 1U);
            EXPECT_TRUE(bus.named().empty());
            for (const auto& [sensor, count] : bus.counts())
                EXPECT_GE(count.share(), 1.0 - 2.5 / 6.5) << int{sensor.second};
        }
    }
}

/// An answer to each SYNC beside the node's own, by a clock that is `ahead_ms` ahead.
Answerer answers_ahead(std::int64_t ahead_ms, std::int64_t delay_us) {
    return [=](wire::NodeId node, const wire::SyncReport& said, std::int64_t arrives_us,
               std::vector<OnTheWay>& way) {
        way.push_back({arrives_us, wire::encode(said, node)});
        if (node != kFirst || arrives_us < kAttackUs) return;
        const wire::SyncReport forged{said.sequence, said.heard + Microseconds{1'000 * ahead_ms}};
        way.push_back({arrives_us + delay_us, wire::encode(forged, node)});
    };
}

TEST(ForgedAnswersToSync, place_no_reading_wrong_cost_nobody_anything_and_are_named_at_the_first) {
    const AttackedBus clean({.nodes = 2, .run_s = 12.0});
    for (const std::int64_t ahead_ms : {-90, -25, 3, 25, 60, 90}) {
        for (const std::int64_t delay_us : {-50, 500}) {  // it answers quicker than the node, and slower
            SCOPED_TRACE(std::to_string(ahead_ms) + " ms, " + std::to_string(delay_us) + " us");
            const AttackedBus bus(
                {.nodes = 2, .run_s = 12.0, .on_answer = answers_ahead(ahead_ms, delay_us)});
            EXPECT_EQ(bus.untrue(), 0U) << bus.pipeline().inputs_text();
            EXPECT_EQ(bus.wrong_voxels(clean), 0U);
            EXPECT_TRUE(bus.replayed_map() == bus.map());
            expect_others_whole(bus, {});  // the attacked node's as well
            ASSERT_TRUE(bus.named_clocks().contains(kFirst));
            EXPECT_LE(bus.named_clocks().at(kFirst), kAttack_s + 1.0);
            EXPECT_FALSE(bus.named_clocks().contains(kOther));
            EXPECT_TRUE(bus.refused().empty());
            EXPECT_EQ(bus.pipeline().intake().clock(kFirst).relocks(), 0U);
        }
    }
}

class HonestBus : public testing::TestWithParam<std::uint32_t> {};

/// 5 % lost, 5 % repeated, 5 % up to 20 ms late, and every three seconds one damaged frame that passes CRC-8.
/// Of the 255 that do not pass for each of these, one.
Reader rough(std::uint32_t seed, bool is_damaged) {
    auto random = std::make_shared<std::mt19937>(seed);
    auto damaged_us = std::make_shared<std::int64_t>(0);
    return [=](wire::NodeId node, const wire::RangeReading& reading, std::int64_t arrives_us,
               std::vector<OnTheWay>& way) {
        const auto chance = [&](double probability) {
            return std::bernoulli_distribution(probability)(*random);
        };
        const std::int64_t late_us = chance(0.05) ? static_cast<std::int64_t>((*random)() % 20'000) : 0;
        way.push_back({arrives_us + late_us, range_frame(node, reading)});
        if (chance(0.05))
            way.push_back({arrives_us + static_cast<std::int64_t>((*random)() % 5'000), way.back().frame});
        if (!is_damaged || arrives_us - *damaged_us < 3'000'000) return;
        *damaged_us = arrives_us;
        wire::CanFrame damaged = range_frame(node, reading);
        for (std::uint32_t i = 0; i < 3; ++i) {
            const auto bit = static_cast<std::uint32_t>(3 + (*random)() % 52);
            damaged.data.at(bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
        }
        wire::CanFrame refused = damaged;
        for (unsigned crc = 0; crc < 256; ++crc) {
            refused.data[7] = static_cast<std::uint8_t>(crc);
            if (!wire::decode(refused)) break;
        }
        way.push_back({arrives_us + 50, refused});
        for (unsigned crc = 0; crc < 256; ++crc) {  // the one of 256 that passes
            damaged.data[7] = static_cast<std::uint8_t>(crc);
            if (wire::decode(damaged)) break;
        }
        way.push_back({arrives_us + 100, damaged});
    };
}

TEST_P(HonestBus, has_nobody_named_and_loses_only_what_the_bus_does) {
    for (const auto& [is_reset, is_damaged] :
         {std::pair{false, true}, std::pair{true, true}, std::pair{false, false}, std::pair{true, false}}) {
        BusSetup setup{.nodes = 2, .run_s = 12.0, .on_reading = rough(GetParam(), is_damaged), .loss = 0.05};
        setup.seed = GetParam();
        setup.holds_phases = GetParam() % 2 == 0;
        if (GetParam() % 3 == 0) setup.budget_ms = 20, setup.period_ms = 33;
        if (is_reset) setup.resets_at_s = 6.0;
        const AttackedBus bus(setup);
        for (const auto& [sensor, at_s] : bus.named())
            ADD_FAILURE() << int{sensor.first} << '.' << int{sensor.second} << " named at " << at_s
                          << bus.pipeline().inputs_text();
        EXPECT_TRUE(bus.named_clocks().empty());
        EXPECT_TRUE(bus.named_words().empty());
        EXPECT_TRUE(bus.losing_s().empty());
        for (const auto& [sensor, count] : bus.counts()) {
            if (is_reset && sensor.first == kFirst) continue;
            EXPECT_GE(count.share(), 0.92) << int{sensor.second};
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Seeds, HonestBus, testing::Range(1U, 13U));

TEST(NodeLosses, over_a_twentieth_of_a_second_s_readings_are_named_with_their_reason) {
    BusSetup setup{.nodes = 2};
    setup.on_reading = attack_on(all_of(setup), [](const Said& said, std::vector<OnTheWay>& way) {
        if (said.count % 10 == 0) put(said, impossible(said.reading, 0), 200, way);
    });
    const AttackedBus bus(setup);
    ASSERT_TRUE(bus.losing_s().contains(kFirst));
    EXPECT_LE(bus.losing_s().at(kFirst), kAttack_s + 1.0);
    EXPECT_EQ(bus.losses().at(kFirst).most, ReadingReason::too_young);
    EXPECT_FALSE(bus.losing_s().contains(kOther));
}

}  // namespace
}  // namespace octoskin::test
