// What may come through a descriptor that somebody else made, of either kind that carries packets.
#include <gtest/gtest.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "common/wire/socketcan_layout.hpp"
#include "host/io/socketcan/can_socket.hpp"

namespace octoskin::socketcan {
namespace {

class PacketSocketTest : public testing::TestWithParam<int> {
  protected:
    PacketSocketTest() {
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, GetParam(), 0, ends.data()) != 0)
            throw std::system_error(errno, std::generic_category());
        other_end_ = ends[1];
        socket_.emplace("fd:3", ends[0], true);
    }
    ~PacketSocketTest() override { hang_up(); }
    void hang_up() {
        if (other_end_ >= 0) ::close(std::exchange(other_end_, -1));
    }
    void put_bytes(std::size_t count) const {
        const std::array<std::byte, 100> bytes{};
        ASSERT_EQ(::send(other_end_, bytes.data(), count, 0), static_cast<ssize_t>(count));
    }
    void put_frame(std::uint32_t id) const {
        const wire::SocketCanBytes raw = wire::to_socketcan({.can_id = id});
        ASSERT_EQ(::send(other_end_, raw.bytes().data(), raw.size, 0), static_cast<ssize_t>(raw.size));
    }
    /// The next frame's identifier; empty: none is there.
    std::optional<std::uint32_t> take() {
        const auto received = socket_->receive();
        EXPECT_TRUE(received) << received.error().message();
        if (!received || !*received) return std::nullopt;
        return (*received)->entry.frame.can_id;
    }
    [[nodiscard]] bool has_ended() { return !socket_->receive(); }

    int other_end_ = -1;
    std::optional<CanSocket> socket_;
};

TEST_P(PacketSocketTest, takes_an_empty_packet_for_a_malformed_one) {
    put_bytes(0);
    put_frame(7);
    put_bytes(0);
    put_bytes(0);
    EXPECT_EQ(take(), 7U);
    EXPECT_EQ(take(), std::nullopt);
    EXPECT_EQ(socket_->malformed(), 3U);
    put_frame(8);
    EXPECT_EQ(take(), 8U) << "the other end goes on";
}

TEST_P(PacketSocketTest, reads_what_was_sent_before_the_other_end_was_shut_down_and_then_sees_it) {
    put_frame(7);
    put_bytes(0);
    put_frame(8);
    ASSERT_EQ(::shutdown(other_end_, SHUT_WR), 0);
    EXPECT_EQ(take(), 7U);
    EXPECT_EQ(take(), 8U) << "the empty packet between them is no end";
    EXPECT_EQ(socket_->malformed(), 1U);
    // The kernel tells nobody of it whose socket is SOCK_DGRAM: such a bus is silent.
    EXPECT_EQ(has_ended(), GetParam() == SOCK_SEQPACKET);
}

TEST_P(PacketSocketTest, sees_that_the_other_end_was_closed) {
    put_frame(7);
    hang_up();
    EXPECT_EQ(take(), 7U);
    // Of a pair of SOCK_DGRAM the kernel tells it to whoever sends.
    const auto sent = socket_->send({.can_id = 1});
    ASSERT_FALSE(sent);
    EXPECT_TRUE(sent.error().error_number == EPIPE || sent.error().error_number == ECONNREFUSED)
        << sent.error().message();
    if (GetParam() == SOCK_SEQPACKET) {
        EXPECT_TRUE(has_ended());
    }
}

TEST_P(PacketSocketTest, takes_no_more_packets_at_once_than_it_may_whatever_they_are) {
    for (int i = 0; i < 6; ++i) put_bytes(5);
    put_frame(7);
    int left = 4;
    EXPECT_FALSE(socket_->receive(left).value()) << "four malformed ones";
    EXPECT_EQ(left, 0);
    EXPECT_EQ(socket_->malformed(), 4U);
    EXPECT_FALSE(socket_->receive(left).value());
    EXPECT_EQ(socket_->malformed(), 4U) << "it may take none";
    left = 4;
    const auto received = socket_->receive(left);
    ASSERT_TRUE(received && *received);
    EXPECT_EQ((*received)->entry.frame.can_id, 7U);
    EXPECT_EQ(left, 1) << "two malformed ones and the frame";
    ASSERT_TRUE(socket_->send({.can_id = 9}).value());
    left = 0;
    EXPECT_FALSE(socket_->receive(left).value()) << "what waits here counts too";
    EXPECT_EQ(take(), 9U);
}

// Whoever sends a frame looks first for what came before it, which in a flood has no end.
TEST_P(PacketSocketTest, sends_beside_a_flood_of_what_is_no_frame) {
    using namespace std::chrono_literals;
    const std::jthread flood([this](const std::stop_token& end) {
        const std::array<std::byte, 5> bytes{};
        while (!end.stop_requested()) (void)::send(other_end_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    });
    while (socket_->malformed() < 100) EXPECT_EQ(take(), std::nullopt);
    std::chrono::steady_clock::duration slowest{};
    for (std::uint32_t i = 0; i < 20; ++i) {
        const auto begun = std::chrono::steady_clock::now();
        ASSERT_TRUE(socket_->send({.can_id = i}));
        slowest = std::max(slowest, std::chrono::steady_clock::now() - begun);
    }
    EXPECT_LT(slowest, 1s);
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, PacketSocketTest, testing::Values(SOCK_SEQPACKET, SOCK_DGRAM),
                         [](const auto& kind) {
                             return kind.param == SOCK_SEQPACKET ? "seqpacket" : "dgram";
                         });

}  // namespace
}  // namespace octoskin::socketcan
