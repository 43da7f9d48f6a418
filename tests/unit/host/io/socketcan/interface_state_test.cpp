// Oracle: the message as the kernel lays it out (rtnetlink(7), <linux/can/netlink.h>), written out here.
#include "host/io/socketcan/interface_state.hpp"

#include <gtest/gtest.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>

#include <cstring>
#include <vector>

namespace octoskin::socketcan {
namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, const void* data, std::size_t size) {
    const auto* const from = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), from, from + size);
    bytes.resize((bytes.size() + 3) / 4 * 4);
}

Bytes attribute(unsigned short type, const Bytes& content, std::size_t size) {
    Bytes bytes;
    const rtattr header{static_cast<unsigned short>(sizeof(rtattr) + size), type};
    append(bytes, &header, sizeof(header));
    append(bytes, content.data(), content.size());
    return bytes;
}

Bytes joined(Bytes first, const Bytes& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

Bytes text(const char* words) {
    Bytes bytes;
    append(bytes, words, std::strlen(words) + 1);
    return bytes;
}

/// A link as `ip -details link show can0` reads it: its name, its kind, and, nested, a clock rate and the
/// state.
Bytes answer(std::uint32_t state, const char* kind = "can", unsigned short type = RTM_NEWLINK,
             unsigned flags = IFF_UP | IFF_NOARP) {
    constexpr unsigned short kState = 4;  // IFLA_CAN_STATE
    Bytes number;
    append(number, &state, sizeof(state));
    const Bytes data = joined(attribute(3, number, 4), attribute(kState, number, 4));
    const Bytes info = joined(attribute(IFLA_INFO_KIND, text(kind), std::strlen(kind) + 1),
                              attribute(IFLA_INFO_DATA | NLA_F_NESTED, data, data.size()));
    const Bytes attributes =
        joined(attribute(IFLA_IFNAME, text("can0"), 5), attribute(IFLA_LINKINFO, info, info.size()));
    Bytes bytes;
    nlmsghdr header{};
    header.nlmsg_type = type;
    header.nlmsg_len = static_cast<std::uint32_t>(sizeof(nlmsghdr) + sizeof(ifinfomsg) + attributes.size());
    append(bytes, &header, sizeof(header));
    ifinfomsg link{};
    link.ifi_flags = flags;
    append(bytes, &link, sizeof(link));
    return joined(bytes, attributes);
}

std::optional<ControllerState> controller_of(const Bytes& bytes) {
    const auto state = interface_state_of(bytes);
    EXPECT_TRUE(state);
    return state ? state->controller : std::nullopt;
}

TEST(InterfaceState, has_each_state_of_a_controller_that_the_kernel_knows) {
    for (std::uint32_t state = 0; state <= 5; ++state)
        EXPECT_EQ(controller_of(answer(state)), static_cast<ControllerState>(state));
    EXPECT_EQ(controller_of(answer(2)), ControllerState::error_passive);
    EXPECT_EQ(controller_of(answer(6)), std::nullopt);
    EXPECT_EQ(controller_of(answer(0xFFFF'FFFF)), std::nullopt);
}

TEST(InterfaceState, of_another_kind_of_link_has_no_controller) {
    EXPECT_EQ(controller_of(answer(0, "vcan")), std::nullopt);
    EXPECT_EQ(controller_of(answer(0, "ca")), std::nullopt);
}

TEST(InterfaceState, is_not_told_by_another_message) {
    EXPECT_EQ(interface_state_of(answer(0, "can", RTM_DELLINK)), std::nullopt);
    EXPECT_EQ(interface_state_of(answer(0, "can", NLMSG_ERROR)), std::nullopt);
}

TEST(InterfaceState, tells_an_interface_that_is_up_from_one_that_is_down_also_without_a_controller) {
    for (const char* const kind : {"can", "vcan"}) {
        EXPECT_TRUE(interface_state_of(answer(0, kind))->is_up);
        EXPECT_FALSE(interface_state_of(answer(4, kind, RTM_NEWLINK, IFF_NOARP | IFF_RUNNING))->is_up);
    }
}

TEST(InterfaceState, survives_every_truncation_and_every_wrong_byte) {
    const Bytes whole = answer(2);
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_EQ(interface_state_of(std::span(whole).first(size)), std::nullopt) << size;
    for (std::size_t at = 0; at < whole.size(); ++at) {
        for (int value = 0; value < 256; ++value) {
            Bytes wrong = whole;
            wrong[at] = static_cast<std::byte>(value);
            const auto state = interface_state_of(wrong);
            EXPECT_TRUE(!state || !state->controller || *state->controller <= ControllerState::sleeping);
        }
    }
}

TEST(InterfaceState, is_what_this_kernel_says) {
    EXPECT_EQ(read_interface_state("no-such-one"), std::nullopt);
    const auto loopback = read_interface_state("lo");
    ASSERT_TRUE(loopback);
    EXPECT_EQ(loopback->controller, std::nullopt);
}

}  // namespace
}  // namespace octoskin::socketcan
