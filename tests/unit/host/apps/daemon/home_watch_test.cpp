// Looks at the maps' folder that hang, and those that do not.
#include "host/apps/daemon/home_watch.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <optional>
#include <stdexcept>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class HomeWatchTest : public testing::Test {
  protected:
    ~HomeWatchTest() override {
        if (!is_let_go_) let_go_.set_value();
    }
    [[nodiscard]] HomeWatch::Looker held() {
        return [gone = let_go_.get_future().share()](MapHome& home) {
            gone.wait();
            return HomeWatch::look(home);
        };
    }
    void let_go() {
        is_let_go_ = true;
        let_go_.set_value();
    }
    [[nodiscard]] static bool is_readable(int descriptor) {
        pollfd watched{descriptor, POLLIN, 0};
        return ::poll(&watched, 1, 5000) == 1;
    }

    testing_support::ScratchFolder scratch_;
    fs::path maps_ = scratch_ / "maps";
    std::promise<void> let_go_;
    bool is_let_go_ = false;
};

TEST_F(HomeWatchTest, tells_of_a_folder_that_was_removed_and_of_the_one_that_is_held_in_its_place) {
    HomeWatch watch(MapHome::take(maps_).value());
    EXPECT_EQ(watch.where(), maps_.string());
    fs::remove_all(maps_);
    watch.ask();
    ASSERT_TRUE(is_readable(watch.descriptor()));
    EXPECT_FALSE(watch.take());
    EXPECT_NE(watch.problem().find("was removed"), std::string::npos) << watch.problem();
    EXPECT_EQ(watch.where(), "");
    fs::create_directory(maps_);
    watch.ask();
    ASSERT_TRUE(is_readable(watch.descriptor()));
    const auto next = watch.take();
    ASSERT_TRUE(next);
    EXPECT_TRUE(fs::equivalent(next->path_for_libraries(), maps_));
    EXPECT_EQ(watch.problem(), "");
    EXPECT_EQ(watch.where(), maps_.string());
}

TEST_F(HomeWatchTest, waits_for_no_look_and_tells_since_when_it_is_at_work) {
    HomeWatch watch(MapHome::take(maps_).value(), held());
    EXPECT_FALSE(watch.looking_since());
    const auto begun = std::chrono::steady_clock::now();
    watch.ask();
    watch.ask();
    EXPECT_FALSE(watch.take());
    const auto since = watch.looking_since();
    ASSERT_TRUE(since);
    EXPECT_FALSE(watch.look_again(Nanoseconds{50'000'000}));
    EXPECT_EQ(watch.looking_since(), since) << "the same still";
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
    let_go();
    ASSERT_TRUE(is_readable(watch.descriptor()));
    EXPECT_FALSE(watch.take()) << "the folder is still the same";
    EXPECT_FALSE(watch.looking_since());
}

TEST_F(HomeWatchTest, looks_once_more_at_the_end) {
    HomeWatch watch(MapHome::take(maps_).value());
    fs::remove_all(maps_);
    fs::create_directory(maps_);
    EXPECT_TRUE(watch.look_again(Nanoseconds{5'000'000'000}));
}

TEST_F(HomeWatchTest, leaves_a_look_that_hangs_behind) {
    std::optional<HomeWatch> watch;
    watch.emplace(MapHome::take(maps_).value(), held());
    watch->ask();
    const auto begun = std::chrono::steady_clock::now();
    watch.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
}

TEST(SideTask, gives_what_came_of_its_work_once_and_throws_what_that_threw) {
    SideTask<int> task;
    EXPECT_FALSE(task.take());
    task.begin([] { return 7; });
    EXPECT_EQ(task.wait(Nanoseconds{5'000'000'000}), 7);
    EXPECT_FALSE(task.begun());
    EXPECT_FALSE(task.take());
    task.begin([]() -> int { throw std::runtime_error("no"); });
    EXPECT_THROW((void)task.wait(Nanoseconds{5'000'000'000}), std::runtime_error);
    task.begin([] { return 8; });
    EXPECT_EQ(task.wait(Nanoseconds{5'000'000'000}), 8);
}

}  // namespace
}  // namespace octoskin
