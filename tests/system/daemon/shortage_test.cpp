// A daemon that has come to the end of the addresses it may have (ulimit -v): it does without, or ends with
// its map saved.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "common/wire/crc.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/map_saver.hpp"
#include "host/apps/query/query_request.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "tests/support/evidence.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class Shortage : public DaemonTest {
  protected:
    static constexpr std::size_t kMib = std::size_t{1} << 20U;

    /// No two voxels of a brick alike: some 2 MiB for each 1000 bricks.
    static FusedMap noise(unsigned bricks) {
        std::mt19937 random(7);
        std::uniform_real_distribution<float> log_odds(-1.0F, 1.0F);
        FusedMap map(fast_mapping().map);
        for (unsigned brick = 0; brick < bricks; ++brick) {
            std::vector<VoxelUpdate> updates;
            for (unsigned voxel = 0; voxel < kBrickVoxels; ++voxel) {
                const auto along = [&](unsigned place, unsigned cell) {
                    return static_cast<std::uint16_t>(20'000 + kBrickEdge * place + cell);
                };
                updates.push_back({{along(brick % 32, voxel % 8), along(brick / 32 % 32, voxel / 8 % 8),
                                    along(brick / 1024, voxel / 64)},
                                   log_odds(random)});
            }
            feed(map, updates);
        }
        return map;
    }
    void save(const FusedMap& map) {
        std::filesystem::create_directories(folder_ / "maps");
        // With its snapshot: from the .ot it would be there twice for a moment, and leave room.
        const std::string text = mapping_text(fast_mapping());
        const SnapshotOrigin origin{
            .mapping_crc32 = crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()})};
        ASSERT_EQ(MapSaver::write_map(map, origin, NamedFolder(folder_ / "maps")), "");
        written_ = std::filesystem::last_write_time(folder_ / "maps/fused.ot");
    }
    void write_mapping(float log_odds_max) const {
        (void)folder_.write("mapping.yaml",
                            fmt::format("base: fast\nmap: {{log_odds_max: {}}}\n", log_odds_max));
    }
    void start_with_mapping(std::vector<std::string> more = {}) {
        more.insert(more.end(), {"--no-camera", "--configuration", (folder_ / "mapping.yaml").string()});
        start(more);
        ASSERT_TRUE(daemon_->wait_until(is_ranging, 30s)) << daemon_->log();
    }
    /// All that it may have from now on: what it takes now, and so much more.
    void limit_addresses(std::size_t more_bytes) const {
        std::ifstream file(fmt::format("/proc/{}/statm", daemon_->process()));
        std::size_t pages = 0;
        ASSERT_TRUE(file >> pages);
        const auto bytes =
            static_cast<rlim_t>(pages * static_cast<std::size_t>(::getpagesize()) + more_bytes);
        const rlimit limit{bytes, bytes};
        ASSERT_EQ(::prlimit(daemon_->process(), RLIMIT_AS, &limit, nullptr), 0);
    }
    [[nodiscard]] bool is_saved_since_start() const {
        return std::filesystem::last_write_time(folder_ / "maps/fused.ot") > written_;
    }
    [[nodiscard]] Json reloads() const { return daemon_->status()["reloads"]; }

  private:
    std::filesystem::file_time_type written_;
};

// Other clamps: all of the map once more.
TEST_F(Shortage, leaves_everything_as_it_was_where_a_reload_needs_more) {
    save(noise(12'000));
    write_mapping(fast_mapping().map.log_odds_max);
    start_with_mapping();
    write_mapping(3.4F);
    limit_addresses(12 * kMib);
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return has_problem(status, "reload_refused"); }, 10s))
        << daemon_->log();
    EXPECT_TRUE(has_problem(daemon_->status(), "beside the old one")) << daemon_->status()["problems"].dump();
    EXPECT_EQ(reloads()["count"], 0);
    const int used = readings_used(daemon_->status());
    EXPECT_TRUE(
        daemon_->wait_until([used](const Json& status) { return readings_used(status) > used + 100; }, 10s))
        << daemon_->log();
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(10s), 0) << daemon_->log();
}

// A question needs far more than there is.
TEST_F(Shortage, that_a_question_finds_ends_in_an_answer_or_with_the_map_saved) {
    save(noise(1'000));
    write_mapping(fast_mapping().map.log_odds_max);
    start_with_mapping();
    limit_addresses(0);
    QueryRequest request;
    request.kind = QueryKind::pockets;
    request.path = {{0.0, 0.0, 0.0, -0.1, 0.0, 1.6, 0.0}};
    request.radius_m = 4.0;
    for (int i = 0; i < 3; ++i) (void)ask_daemon(folder_ / "control", to_line(request), 20s);
    daemon_->signal(SIGTERM);
    const auto code = daemon_->wait(10s);
    EXPECT_TRUE(code == 0 || code == static_cast<int>(ExitCode::no_resources))
        << code.value_or(-1) << daemon_->log();
    EXPECT_TRUE(is_saved_since_start()) << daemon_->log();
}

// The thread that saves has asked for nothing before.
TEST_F(Shortage, does_not_keep_the_last_save_from_being_done) {
    save(noise(12'000));
    write_mapping(fast_mapping().map.log_odds_max);
    start_with_mapping({"--save-every", "1000"});
    limit_addresses(0);
    daemon_->signal(SIGTERM);
    const auto code = daemon_->wait(10s);
    EXPECT_TRUE(code == 0 || code == static_cast<int>(ExitCode::no_resources))
        << code.value_or(-1) << daemon_->log();
    EXPECT_TRUE(is_saved_since_start()) << daemon_->log();
}

}  // namespace
}  // namespace octoskin::test
