// What a watcher is sent around a reload, step by step.
#include "host/apps/daemon/watcher.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

using watch::FrameKind;

/// Single voxels, each in a brick of its own: more than one payload of a map.
FusedMap map_of_many_bricks() {
    FusedMap map{MapConfig{}};
    std::vector<VoxelUpdate> updates;
    for (int y = 0; y < 80; ++y)
        for (int z = 0; z < 80; ++z)
            updates.push_back({{32'768, static_cast<std::uint16_t>(32'768 + 8 * y),
                                static_cast<std::uint16_t>(32'768 + 8 * z)},
                               1.0F});
    feed(map, updates, SensorKind::camera);
    return map;
}

WatchEvent event(FrameKind kind, std::string payload, std::int64_t time = 0) {
    return {kind, {time}, std::make_shared<const std::string>(std::move(payload))};
}
WatchEvent reload(std::uint64_t reloads) {
    return event(FrameKind::reload, watch::reload_payload(reloads));
}

/// "map 1", "joints 7", "reload 2": the next bytes, as if all were sent.
std::vector<std::string> next(Watcher& watcher, const MapNow* now) {
    std::string_view bytes = watcher.pending(now);
    watcher.on_sent(bytes.size());
    std::vector<std::string> frames;
    while (const auto header = watch::parse_header(bytes)) {
        const std::string_view payload = bytes.substr(watch::kHeaderBytes, header->bytes);
        if (header->kind == FrameKind::map) frames.push_back(fmt::format("map {}", header->time.ns));
        if (header->kind == FrameKind::joints) frames.push_back(fmt::format("joints {}", header->time.ns));
        if (header->kind == FrameKind::reload)
            frames.push_back(fmt::format("reload {}", watch::parse_reload(payload).value()));
        bytes.remove_prefix(watch::kHeaderBytes + header->bytes);
    }
    return frames;
}

using Frames = std::vector<std::string>;
constexpr WatchWants kAll{true, true, true, true};

TEST(Watcher, sends_no_rest_of_a_map_of_the_rig_before_a_reload) {
    const MapNow before{map_of_many_bricks(), {1}};
    Watcher watcher(kAll, "");
    watcher.on_map(before, {});
    EXPECT_EQ(next(watcher, &before), (Frames{"map 1"}));
    EXPECT_EQ(next(watcher, &before), (Frames{"map 1"})) << "it has several payloads";
    watcher.on_event(reload(1));
    EXPECT_EQ(next(watcher, &before), (Frames{"reload 1"}));
    EXPECT_EQ(next(watcher, &before), Frames{});
    const MapNow after{before.map.copy(), {2}};
    watcher.on_map(after, {});
    EXPECT_EQ(next(watcher, &after), (Frames{"map 2"})) << "the rest";
}

TEST(Watcher, sends_no_map_ahead_of_the_reload_that_came_before_it) {
    const MapNow now{map_of_many_bricks(), {3}};
    Watcher watcher(kAll, "");
    const std::string half(Watcher::kChunkBytes / 2, ' ');
    for (int i = 1; i <= 4; ++i) watcher.on_event(event(FrameKind::joints, half, i));
    watcher.on_event(reload(1));
    watcher.on_map(now, {});
    EXPECT_EQ(next(watcher, &now), (Frames{"joints 1", "joints 2"}));
    EXPECT_EQ(next(watcher, &now), (Frames{"joints 3", "joints 4"}));
    EXPECT_EQ(next(watcher, &now), (Frames{"reload 1", "map 3"}));
}

TEST(Watcher, loses_samples_and_no_reload_when_too_many_wait) {
    const MapNow now{map_of_many_bricks(), {3}};
    Watcher watcher({.map = true, .joints = true}, "");
    constexpr auto kMax = static_cast<std::int64_t>(Watcher::kEventsMax);
    watcher.on_event(event(FrameKind::joints, "", 0));
    watcher.on_event(reload(1));
    watcher.on_event(event(FrameKind::joints, "", 1));
    watcher.on_event(reload(2));
    for (std::int64_t i = 2; i < 2 + kMax; ++i) watcher.on_event(event(FrameKind::joints, "", i));
    watcher.on_map(now, {});
    const Frames sent = next(watcher, &now);
    ASSERT_EQ(sent.size(), Watcher::kEventsMax + 2);
    EXPECT_EQ(sent[0], "reload 2") << "what was of the rig between is lost";
    EXPECT_EQ(sent[1], "joints 2");
    EXPECT_EQ(sent.back(), "map 3");
    watcher.on_event(reload(3));
    EXPECT_EQ(next(watcher, &now), (Frames{"reload 3"}));
}

TEST(Watcher, loses_no_newest_robot_when_too_many_wait) {
    Watcher watcher({.joints = true, .robot = true}, "");
    constexpr auto kMax = static_cast<std::int64_t>(Watcher::kEventsMax);
    watcher.on_event(event(FrameKind::robot, "first"));
    watcher.on_event(reload(1));
    watcher.on_event(event(FrameKind::robot, "second"));
    for (std::int64_t i = 0; i < kMax; ++i) watcher.on_event(event(FrameKind::joints, "", i));
    const std::string bytes(watcher.pending(nullptr));
    EXPECT_EQ(bytes.find("first"), std::string::npos);
    EXPECT_LT(bytes.find(watch::reload_payload(1)), bytes.find("second"));
    EXPECT_LT(bytes.find("second"), 200U);
    EXPECT_EQ(next(watcher, nullptr).size(), Watcher::kEventsMax + 1) << "the reload, and all samples";
}

TEST(Watcher, gets_a_reload_whatever_it_asked_for) {
    Watcher watcher({.status = true}, "");
    watcher.on_event(event(FrameKind::joints, "", 1));
    watcher.on_event(reload(9));
    EXPECT_EQ(next(watcher, nullptr), (Frames{"reload 9"}));
}

}  // namespace
}  // namespace octoskin
