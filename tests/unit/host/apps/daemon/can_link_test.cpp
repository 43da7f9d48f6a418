#include "host/apps/daemon/can_link.hpp"

#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace octoskin {
namespace {

constexpr Nanoseconds kMs{1'000'000};

/// An interface that a test takes away and gives back.
class CanLinkTest : public testing::Test {
  protected:
    CanLinkTest()
        : link_(
              [this]() -> Result<socketcan::CanSocket, socketcan::SocketFault> {
                  ++tries_;
                  if (!is_there_)
                      return unexpected(socketcan::SocketFault{"can0", ENODEV, "no such interface"});
                  std::array<int, 2> ends{};
                  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()), 0);
                  unplug();
                  other_.emplace("can0", ends[1]);
                  return socketcan::CanSocket("can0", ends[0], true);
              },
              {}, [this] { return state_; }) {}
    void unplug() { other_.reset(); }
    void say(std::uint32_t error_class, std::uint8_t controller = 0) {
        wire::CanFrame frame{.can_id = error_class, .is_error = true, .payload_len = 8};
        frame.data[1] = controller;
        ASSERT_TRUE(other_->send(frame).value());
        EXPECT_FALSE(link_.receive()) << "an error frame is no traffic";
    }

    void hear_one() {
        ASSERT_TRUE(other_->send({.can_id = 5}).value());
        EXPECT_TRUE(link_.receive());
    }
    void send_one() {
        ASSERT_TRUE(link_.send({.can_id = 6}));
        EXPECT_TRUE(link_.receive()) << "its echo";
    }

    bool is_there_ = true;
    std::optional<socketcan::InterfaceState> state_;  ///< what the kernel says
    int tries_ = 0;
    HostTime now_;
    std::optional<socketcan::CanSocket> other_;
    CanLink link_;
};

TEST_F(CanLinkTest, is_tried_again_until_it_is_there_and_not_more_often_than_it_says) {
    is_there_ = false;
    HostTime now{};
    for (int ms = 0; ms < 1000; ms += 10) EXPECT_FALSE(link_.attend(now + ms * kMs));
    EXPECT_EQ(tries_, 5);
    EXPECT_EQ(link_.state(), LinkState::absent);
    EXPECT_EQ(link_.why(), "can0: no such interface");
    EXPECT_FALSE(link_.send({}));
    is_there_ = true;
    EXPECT_TRUE(link_.attend(now + 1000 * kMs));
    EXPECT_EQ(link_.state(), LinkState::up);
    EXPECT_TRUE(link_.why().empty());
    EXPECT_EQ(link_.counts().reopened, 0U);
    EXPECT_EQ(link_.counts().not_sent, 1U);
}

TEST_F(CanLinkTest, is_opened_anew_when_it_went_away) {
    ASSERT_TRUE(link_.attend({}));
    unplug();
    EXPECT_FALSE(link_.receive());
    EXPECT_EQ(link_.state(), LinkState::absent);
    EXPECT_EQ(link_.descriptor(), -1);
    EXPECT_TRUE(link_.attend(HostTime{} + CanLink::kRetry));
    EXPECT_EQ(link_.counts().reopened, 1U);
    ASSERT_TRUE(other_->send({.can_id = 5}).value());
    const auto received = link_.receive();
    ASSERT_TRUE(received);
    EXPECT_EQ(received->entry.frame.can_id, 5U);
    EXPECT_EQ(link_.counts().received, 1U);
}

TEST_F(CanLinkTest, tells_bus_off_from_error_passive_and_from_well) {
    ASSERT_TRUE(link_.attend({}));
    say(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING);
    EXPECT_EQ(link_.state(), LinkState::up);
    say(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    EXPECT_EQ(link_.state(), LinkState::error_passive);
    say(CAN_ERR_BUSOFF);
    EXPECT_EQ(link_.state(), LinkState::bus_off);
    EXPECT_NE(link_.why().find("bus-off"), std::string::npos);
    say(CAN_ERR_RESTARTED);
    EXPECT_EQ(link_.state(), LinkState::up);
    say(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE);
    EXPECT_EQ(link_.state(), LinkState::error_passive);
    say(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    EXPECT_EQ(link_.state(), LinkState::up);
    EXPECT_EQ(link_.counts().bus_off, 1U);
    EXPECT_EQ(link_.counts().error_frames, 6U);
    EXPECT_EQ(link_.counts().received, 0U);
}

TEST_F(CanLinkTest, is_opened_anew_for_other_filters_where_the_descriptor_takes_none) {
    ASSERT_TRUE(link_.attend({}));
    int others = 0;
    link_.change_filters(
        [&]() -> Result<socketcan::CanSocket, socketcan::SocketFault> {
            ++others;
            return unexpected(socketcan::SocketFault{"can1", ENODEV, "no"});
        },
        {});
    EXPECT_EQ(link_.descriptor(), -1) << "a Unix socket knows nothing of CAN";
    EXPECT_FALSE(link_.attend({}));
    EXPECT_EQ(others, 1);
}

TEST_F(CanLinkTest, believes_the_kernel_about_a_controller_that_recovers_without_a_word) {
    using socketcan::ControllerState;
    ASSERT_TRUE(link_.attend({}));
    for (const auto recovered : {ControllerState::error_active, ControllerState::error_warning}) {
        say(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
        state_ = {true, ControllerState::error_passive};
        EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
        EXPECT_EQ(link_.state(), LinkState::error_passive);
        state_ = {true, recovered};
        EXPECT_FALSE(link_.attend(now_ + CanLink::kAsk - Nanoseconds{1}));
        EXPECT_EQ(link_.state(), LinkState::error_passive) << "asked more than once a second";
        EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
        EXPECT_EQ(link_.state(), LinkState::up);
    }
    state_ = {true, ControllerState::bus_off};
    EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
    EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
    EXPECT_EQ(link_.state(), LinkState::bus_off);
    EXPECT_EQ(link_.counts().bus_off, 1U);
    state_ = {true, ControllerState::stopped};
    EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
    EXPECT_EQ(link_.state(), LinkState::bus_off);
    state_.reset();
    EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
    EXPECT_EQ(link_.state(), LinkState::bus_off) << "nobody said anything";
}

TEST_F(CanLinkTest, is_down_and_up_again_as_the_kernel_says_where_nobody_sends) {
    using socketcan::ControllerState;
    for (const auto controller :
         {std::optional<ControllerState>(), std::optional(ControllerState::stopped)}) {
        state_ = {true, std::nullopt};
        (void)link_.attend(now_ = now_ + CanLink::kAsk);
        state_ = {false, controller};
        EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
        EXPECT_EQ(link_.state(), LinkState::down);
        EXPECT_NE(link_.why().find("bring it up"), std::string::npos) << link_.why();
        EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
        EXPECT_EQ(link_.state(), LinkState::down) << "it stays so";
        state_ = {true, std::nullopt};
        EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kRetry));
        EXPECT_EQ(link_.state(), LinkState::up) << "within 0.2 s";
    }
    EXPECT_EQ(link_.counts().went_down, 2U);
    state_.reset();  // nobody can say
    EXPECT_FALSE(link_.attend(now_ = now_ + CanLink::kAsk));
    EXPECT_EQ(link_.state(), LinkState::up);
}

TEST_F(CanLinkTest, is_no_longer_error_passive_after_128_frames_that_were_acknowledged) {
    ASSERT_TRUE(link_.attend({}));
    say(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    for (int i = 0; i < 127; ++i) send_one();
    EXPECT_EQ(link_.state(), LinkState::error_passive);
    say(CAN_ERR_PROT);  // an error: it counts up again
    for (int i = 0; i < 127; ++i) send_one();
    for (int i = 0; i < 300; ++i) hear_one();
    EXPECT_EQ(link_.state(), LinkState::error_passive) << "hearing is no proof of being heard";
    send_one();
    EXPECT_EQ(link_.state(), LinkState::up);
}

TEST_F(CanLinkTest, is_no_longer_error_passive_as_a_receiver_when_it_hears_a_frame) {
    ASSERT_TRUE(link_.attend({}));
    say(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE);
    send_one();
    EXPECT_EQ(link_.state(), LinkState::error_passive);
    hear_one();
    EXPECT_EQ(link_.state(), LinkState::up);
}

TEST_F(CanLinkTest, is_no_longer_bus_off_when_it_hears_a_frame) {
    ASSERT_TRUE(link_.attend({}));
    say(CAN_ERR_BUSOFF);
    EXPECT_EQ(link_.state(), LinkState::bus_off);
    ASSERT_TRUE(other_->send({.can_id = 5}).value());
    EXPECT_TRUE(link_.receive());
    EXPECT_EQ(link_.state(), LinkState::up);
    say(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    ASSERT_TRUE(other_->send({.can_id = 5}).value());
    EXPECT_TRUE(link_.receive());
    EXPECT_EQ(link_.state(), LinkState::error_passive) << "who is error-passive still hears";
}

}  // namespace
}  // namespace octoskin
