// Every packet that is taken for a frame can be sent again and written into a log, and is then the same.
#include "common/wire/socketcan_layout.hpp"

#include <gtest/gtest.h>
#include <linux/can.h>

#include <array>
#include <cstring>

#include "host/io/candump/log_line.hpp"

namespace octoskin {
namespace {

constexpr std::array<std::uint32_t, 3> kFlags{CAN_EFF_FLAG, CAN_RTR_FLAG, CAN_ERR_FLAG};

struct Packet {
    std::uint32_t id;
    bool is_fd;
    unsigned length;

    [[nodiscard]] std::optional<wire::CanFrame> frame() const {
        canfd_frame raw{};
        raw.can_id = id;
        raw.len = static_cast<std::uint8_t>(length);
        raw.flags = 0xFF;
        std::memset(raw.data, 0xA5, sizeof(raw.data));
        return wire::from_socketcan(std::as_bytes(std::span(&raw, 1)).first(is_fd ? CANFD_MTU : CAN_MTU));
    }
};

/// All flags, both formats, every length, identifiers at the borders.
template <class Look>
void for_each_packet(const Look& look) {
    for (std::uint32_t set = 0; set < 1U << kFlags.size(); ++set) {
        std::uint32_t flags = 0;
        for (std::size_t i = 0; i < kFlags.size(); ++i) flags |= (set >> i & 1U) != 0 ? kFlags[i] : 0U;
        for (const std::uint32_t id : {0U, 0x7FFU, 0x800U, 0x1FFF'FFFFU})
            for (const bool is_fd : {false, true})
                for (unsigned length = 0; length < 256; ++length) look(Packet{id | flags, is_fd, length});
    }
}

TEST(SocketCanLayout, is_a_frame_of_every_kind_that_can_has_and_of_no_other) {
    for_each_packet([](const Packet& packet) {
        const bool is_remote = (packet.id & CAN_RTR_FLAG) != 0;
        const bool is_error = (packet.id & CAN_ERR_FLAG) != 0;
        const bool is_kind = !(packet.is_fd && (is_remote || is_error)) && !(is_remote && is_error);
        const bool is_length = packet.is_fd ? wire::is_fd_length(packet.length) : packet.length <= 8;
        ASSERT_EQ(packet.frame().has_value(), is_kind && is_length)
            << std::hex << packet.id << (packet.is_fd ? " FD " : " classical ") << packet.length;
    });
}

TEST(SocketCanLayout, of_each_packet_is_the_same_frame_when_it_is_sent_again_or_read_from_a_log) {
    int frames = 0;
    for_each_packet([&](const Packet& packet) {
        const auto frame = packet.frame();
        if (!frame) return;
        ++frames;
        ASSERT_EQ(wire::from_socketcan(wire::to_socketcan(*frame).bytes()), frame) << std::hex << packet.id;
        const candump::LogEntry entry{.stamp = {1'000'000}, .interface = "can0", .frame = *frame};
        const std::string line = candump::format_line(entry);
        const auto read = candump::parse_line(std::string_view(line).substr(0, line.size() - 1));
        ASSERT_TRUE(read) << line;
        ASSERT_EQ(*read, entry) << line;
    });
    // Classical: data, remote and error, 9 lengths, with and without the extended flag; FD: data, 16 lengths.
    EXPECT_EQ(frames, 4 * 2 * (3 * 9 + 16));
}

}  // namespace
}  // namespace octoskin
