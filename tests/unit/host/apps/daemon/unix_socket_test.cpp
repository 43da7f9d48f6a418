#include "host/apps/daemon/unix_socket.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/apps/daemon/stopped_listener.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

TEST(UnixSocket, is_given_to_one_of_many_that_begin_at_once) {
    const testing_support::ScratchFolder folder;
    for (const int type : {SOCK_STREAM, SOCK_DGRAM}) {
        for (int round = 0; round < 50; ++round) {
            const auto file = folder / ("socket" + std::to_string(type));
            const auto dead =
                bind_unix_socket(file, type);  // a name, and nobody behind: each wants to replace it
            ASSERT_TRUE(dead);
            ::close(dead->descriptor);
            std::atomic<int> waiting = 4;
            std::array<int, 4> got{-1, -1, -1, -1};
            std::vector<std::thread> threads;
            for (int& mine : got) {
                threads.emplace_back([&] {
                    --waiting;
                    while (waiting > 0) std::this_thread::yield();
                    if (const auto bound = bind_unix_socket(file, type)) mine = bound->descriptor;
                });
            }
            for (std::thread& thread : threads) thread.join();
            EXPECT_EQ(std::ranges::count_if(got, [](int descriptor) { return descriptor >= 0; }), 1) << round;
            EXPECT_TRUE(connect_unix_socket(file, type)) << "its name was taken away";
            for (const int descriptor : got)
                if (descriptor >= 0) ::close(descriptor);
            ::unlink(file.c_str());
        }
    }
}

/// A lock of the folder can be held by each user who may read it.
TEST(UnixSocket, is_given_in_a_folder_that_another_has_locked_and_leaves_nothing_else_there) {
    const testing_support::ScratchFolder folder;
    const int others = ::open(folder.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(::flock(others, LOCK_EX), 0);
    const auto bound = bind_unix_socket(folder / "control", SOCK_STREAM);
    EXPECT_TRUE(bound);
    ::close(others);
    ::close(bound.value().descriptor);
    ::unlink((folder / "control").c_str());
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(UnixSocket, for_datagrams_is_refused_without_the_others_process) {
    const testing_support::ScratchFolder folder;
    const auto first = bind_unix_socket(folder / "joints", SOCK_DGRAM);
    ASSERT_TRUE(first);
    const auto second = bind_unix_socket(folder / "joints", SOCK_DGRAM, "--joints");
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(second.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(second.error().error.file, folder / "joints");
    EXPECT_EQ(second.error().error.what, "another octoskin has this socket");
    EXPECT_NE(second.error().error.remedy.find("--joints"), std::string::npos) << second.error().message();
    ::close(first->descriptor);
}

TEST(UnixSocket, is_never_made_over_something_else) {
    const testing_support::ScratchFolder folder;
    const auto file = folder.write("precious", "words");
    const auto bound = bind_unix_socket(file, SOCK_DGRAM);
    ASSERT_FALSE(bound);
    EXPECT_EQ(bound.error().error.code, ErrorCode::wrong_kind_of_file);
    EXPECT_EQ(bound.error().error.file, file);
    EXPECT_EQ(testing_support::ScratchFolder::read(file), "words");
    const auto nowhere = bind_unix_socket(folder / "no/such/folder", SOCK_DGRAM);
    ASSERT_FALSE(nowhere);
    EXPECT_EQ(nowhere.error().error.code, ErrorCode::not_found);
    const auto too_long = bind_unix_socket(folder.path() / std::string(200, 'x'), SOCK_DGRAM);
    ASSERT_FALSE(too_long);
    EXPECT_EQ(too_long.error().error.code, ErrorCode::bad_name);
    EXPECT_EQ(too_long.error().error.value, std::to_string(folder.path().string().size() + 201) + " bytes");
}

/// A file or a socket of another program under the same name is kept.
TEST(UnixSocket, is_removed_only_while_its_name_is_its_own) {
    const testing_support::ScratchFolder folder;
    const auto file = folder / "control";
    const auto first = bind_unix_socket(file, SOCK_STREAM);
    ASSERT_TRUE(first);
    std::filesystem::remove(file);
    first->file.remove();  // nothing is there
    folder.write("control", "precious");
    first->file.remove();
    EXPECT_EQ(testing_support::ScratchFolder::read(file), "precious");
    std::filesystem::remove(file);
    const auto second = bind_unix_socket(file, SOCK_STREAM);
    ASSERT_TRUE(second);
    first->file.remove();
    EXPECT_TRUE(connect_unix_socket(file, SOCK_STREAM));
    second->file.remove();
    EXPECT_FALSE(std::filesystem::exists(file));
    for (const int descriptor : {first->descriptor, second->descriptor}) ::close(descriptor);
}

TEST(UnixSocket, refuses_at_once_the_place_of_one_that_lets_nobody_in) {
    const testing_support::ScratchFolder folder;
    testing_support::StoppedListener stopped(folder / "control");
    stopped.fill();
    const auto begun = std::chrono::steady_clock::now();
    const auto second = bind_unix_socket(folder / "control", SOCK_STREAM);
    ASSERT_FALSE(second);
    EXPECT_LE(std::chrono::steady_clock::now() - begun, 2s);
    EXPECT_EQ(second.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(second.error().error.file, folder / "control");
    EXPECT_NE(second.error().error.what.find("(it accepts no connection: is it stopped?)"), std::string::npos)
        << second.error().message();
}

}  // namespace
}  // namespace octoskin
