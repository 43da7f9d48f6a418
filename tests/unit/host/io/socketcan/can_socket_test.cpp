// Over a socketpair: what a raw CAN socket of the kernel does beyond that needs a kernel with CAN.
#include "host/io/socketcan/can_socket.hpp"

#include <gtest/gtest.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "common/wire/socketcan_layout.hpp"

namespace octoskin::socketcan {
namespace {

class CanSocketTest : public testing::Test {
  protected:
    CanSocketTest() {
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()) != 0)
            throw std::system_error(errno, std::generic_category());
        other_end_ = ends[1];
        socket_.emplace("can7", ends[0]);
    }
    ~CanSocketTest() override { hang_up(); }
    void hang_up() {
        if (other_end_ >= 0) ::close(std::exchange(other_end_, -1));
    }
    void put(const void* bytes, std::size_t size) const {
        ASSERT_EQ(::send(other_end_, bytes, size, 0), static_cast<ssize_t>(size));
    }
    std::optional<wire::CanFrame> take() {
        const auto received = socket_->receive();
        EXPECT_TRUE(received) << received.error().message();
        if (!received || !*received) return std::nullopt;
        return (*received)->entry.frame;
    }

    int other_end_ = -1;
    std::optional<CanSocket> socket_;
};

wire::CanFrame frame_of(std::uint32_t id, std::uint8_t length) {
    wire::CanFrame frame{.can_id = id, .payload_len = length};
    for (std::uint8_t i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(0xA0 + i);
    return frame;
}

TEST_F(CanSocketTest, has_nothing_while_nothing_is_there) {
    EXPECT_EQ(take(), std::nullopt);
}

TEST_F(CanSocketTest, reads_what_the_kernel_lays_out) {
    can_frame classical{};
    classical.can_id = 0x20A;
    classical.can_dlc = 3;
    std::memcpy(classical.data, "\x01\x02\x03", 3);
    put(&classical, sizeof(classical));
    const auto frame = take();
    ASSERT_TRUE(frame);
    wire::CanFrame expected{.can_id = 0x20A, .payload_len = 3};
    expected.data = {1, 2, 3};
    EXPECT_EQ(*frame, expected);

    canfd_frame fd{};
    fd.can_id = 0x241;
    fd.len = 12;
    fd.flags = CANFD_BRS;
    fd.data[11] = 0x77;
    put(&fd, sizeof(fd));
    const auto fd_frame = take();
    ASSERT_TRUE(fd_frame);
    EXPECT_TRUE(fd_frame->is_fd);
    EXPECT_TRUE(fd_frame->has_bit_rate_switch);
    EXPECT_EQ(fd_frame->payload_len, 12);
    EXPECT_EQ(fd_frame->data[11], 0x77);
}

TEST_F(CanSocketTest, tells_extended_remote_and_error_frames_apart) {
    can_frame raw{};
    raw.can_id = 0x1ABCDEF0 | CAN_EFF_FLAG;
    put(&raw, sizeof(raw));
    auto frame = take();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->is_extended);
    EXPECT_EQ(frame->can_id, 0x1ABCDEF0U);

    raw.can_id = 0x123 | CAN_RTR_FLAG;
    raw.can_dlc = 4;
    std::memset(raw.data, 0xEE, 8);  // whatever is there is no data
    put(&raw, sizeof(raw));
    frame = take();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->is_remote);
    EXPECT_EQ(frame->payload_len, 4);
    EXPECT_EQ(frame->data[0], 0);

    raw.can_id = CAN_ERR_FLAG | 0x40U;  // bus-off
    raw.can_dlc = 8;
    put(&raw, sizeof(raw));
    frame = take();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->is_error);
    EXPECT_EQ(frame->can_id, 0x40U);
}

TEST_F(CanSocketTest, gives_back_every_frame_that_it_sent_from_the_other_end) {
    CanSocket other("can7", std::exchange(other_end_, -1));
    for (const std::uint32_t id : {0U, 1U, 0x400U, 0x7FFU}) {
        for (int length = 0; length <= 64; ++length) {
            for (const bool is_fd : {false, true}) {
                if (is_fd ? !wire::is_fd_length(static_cast<std::size_t>(length)) : length > 8) continue;
                wire::CanFrame frame = frame_of(id, static_cast<std::uint8_t>(length));
                frame.is_fd = is_fd;
                frame.has_bit_rate_switch = is_fd && length % 2 == 0;
                ASSERT_TRUE(socket_->send(frame).value());
                const auto received = other.receive();
                ASSERT_TRUE(received && *received);
                ASSERT_EQ((*received)->entry.frame, frame);
                ASSERT_FALSE((*received)->is_own);
            }
        }
    }
}

TEST_F(CanSocketTest, counts_what_is_no_frame_and_reads_on) {
    std::array<std::byte, 100> bytes{};
    std::uint64_t malformed = 0;
    for (std::size_t size = 1; size < bytes.size(); ++size) {
        if (size == CAN_MTU || size == CANFD_MTU) continue;
        put(bytes.data(), size);
        ++malformed;
    }
    can_frame too_long{};
    too_long.can_dlc = 9;
    put(&too_long, sizeof(too_long));
    canfd_frame odd{};
    odd.len = 13;
    put(&odd, sizeof(odd));
    malformed += 2;
    can_frame good{};
    good.can_id = 0x55;
    put(&good, sizeof(good));
    const auto frame = take();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->can_id, 0x55U);
    EXPECT_EQ(socket_->malformed(), malformed);
}

TEST_F(CanSocketTest, says_when_there_is_no_room_and_goes_on_when_there_is) {
    std::uint32_t sent = 0;
    while (true) {
        const auto taken = socket_->send(frame_of(sent % 0x7FF, 8));
        ASSERT_TRUE(taken) << taken.error().message();
        if (!*taken) break;
        ASSERT_LT(++sent, 1'000'000U);
    }
    EXPECT_GT(sent, 10U);
    std::array<std::byte, 100> bytes{};
    while (::recv(other_end_, bytes.data(), bytes.size(), MSG_DONTWAIT) > 0) --sent;
    EXPECT_EQ(sent, 0U);
    EXPECT_TRUE(socket_->send(frame_of(1, 8)).value());
}

TEST_F(CanSocketTest, says_that_the_other_end_is_gone_and_does_not_die_of_it) {
    hang_up();
    const auto received = socket_->receive();
    ASSERT_FALSE(received);
    EXPECT_NE(received.error().message().find("can7: closed"), std::string::npos)
        << received.error().message();
    const auto sent = socket_->send(frame_of(1, 8));
    ASSERT_FALSE(sent);
    EXPECT_EQ(sent.error().error_number, EPIPE);
}

TEST_F(CanSocketTest, stamps_no_frame_before_it_was_sent_or_after_it_was_read) {
    timespec before{};
    ::clock_gettime(CLOCK_REALTIME, &before);
    can_frame raw{};
    put(&raw, sizeof(raw));
    const auto received = socket_->receive();
    ASSERT_TRUE(received && *received);
    timespec after{};
    ::clock_gettime(CLOCK_REALTIME, &after);
    EXPECT_GE((*received)->entry.stamp.ns, before.tv_sec * 1'000'000'000LL + before.tv_nsec);
    EXPECT_LE((*received)->entry.stamp.ns, after.tv_sec * 1'000'000'000LL + after.tv_nsec);
}

TEST(CanSocketOpen, names_the_interface_and_what_to_do) {
    const auto socket = CanSocket::open("nocan9");
    ASSERT_FALSE(socket);
    EXPECT_EQ(socket.error().message().rfind("nocan9: cannot ", 0), 0U) << socket.error().message();
    EXPECT_NE(socket.error().message().find('('), std::string::npos) << socket.error().message();
}

TEST(CanSocketOpen, refuses_a_name_that_a_log_cannot_have) {
    for (const char* name : {"can#0", "123#00", "a b", "", "sixteen_letters_"}) {
        const auto socket = CanSocket::open(name);
        ASSERT_FALSE(socket) << name;
        EXPECT_EQ(socket.error().error_number, EINVAL) << name;
    }
}

TEST(CanSocketOpen, moves_its_descriptor) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()), 0);
    CanSocket first("a", ends[0]);
    CanSocket second("b", ends[1]);
    CanSocket moved(std::move(first));
    EXPECT_EQ(moved.descriptor(), ends[0]);
    moved = std::move(second);
    EXPECT_EQ(moved.descriptor(), ends[1]);
    EXPECT_EQ(moved.interface(), "b");
}

TEST_F(CanSocketTest, gives_its_own_frame_back_after_what_came_before_it_and_before_what_came_after) {
    socket_.emplace("can7", ::dup(socket_->descriptor()), true);
    const auto put_frame = [this](std::uint32_t id) {
        const wire::SocketCanBytes raw = wire::to_socketcan(frame_of(id, 1));
        put(raw.bytes().data(), raw.size);
    };
    put_frame(1);
    put_frame(2);
    ASSERT_TRUE(socket_->send(frame_of(3, 1)).value());
    put_frame(4);
    ASSERT_TRUE(socket_->send(frame_of(5, 1)).value());
    std::int64_t stamp_before = 0;
    for (std::uint32_t id = 1; id <= 5; ++id) {
        const auto received = socket_->receive();
        ASSERT_TRUE(received && *received);
        EXPECT_EQ((*received)->entry.frame.can_id, id);
        EXPECT_EQ((*received)->is_own, id == 3 || id == 5);
        EXPECT_GE((*received)->entry.stamp.ns, stamp_before) << id;
        stamp_before = (*received)->entry.stamp.ns;
    }
    EXPECT_EQ(take(), std::nullopt);
}

}  // namespace
}  // namespace octoskin::socketcan
