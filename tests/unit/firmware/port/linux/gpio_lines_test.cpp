// GPIO lines whose chip goes away, or refuses. The functions of libgpiod that this program has take the place
// of the library's.
#include "firmware/port/linux/gpio_lines.hpp"

#include <gpiod.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

namespace {

/// What is behind a line: `event` is readable where it fell, and for good once its chip is gone.
struct StandIn {
    int event = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    bool is_gone = false;
    bool refuses = false;
    int value = -1;
};
StandIn* stand_in = nullptr;

bool is_readable(int descriptor) {
    pollfd ready{.fd = descriptor, .events = POLLIN, .revents = 0};
    return descriptor >= 0 && ::poll(&ready, 1, 0) == 1;
}

}  // namespace

extern "C" {
gpiod_chip* gpiod_chip_open_lookup(const char* /*name*/) {
    return reinterpret_cast<gpiod_chip*>(stand_in);
}
void gpiod_chip_close(gpiod_chip* /*chip*/) {}
gpiod_line* gpiod_chip_get_line(gpiod_chip* chip, unsigned /*offset*/) {
    return reinterpret_cast<gpiod_line*>(chip);
}
int gpiod_line_request_output(gpiod_line* /*line*/, const char* /*consumer*/, int value) {
    stand_in->value = value;
    return 0;
}
int gpiod_line_request_falling_edge_events_flags(gpiod_line* /*line*/, const char* /*consumer*/,
                                                 int /*flags*/) {
    return 0;
}
int gpiod_line_set_value(gpiod_line* /*line*/, int value) {
    if (stand_in->refuses) {
        errno = ENODEV;
        return -1;
    }
    stand_in->value = value;
    return 0;
}
int gpiod_line_event_get_fd(gpiod_line* /*line*/) {
    return stand_in->event;
}
int gpiod_line_event_wait(gpiod_line* /*line*/, const timespec* /*timeout*/) {
    return is_readable(stand_in->event) ? 1 : 0;
}
int gpiod_line_event_read_multiple(gpiod_line* /*line*/, gpiod_line_event* /*events*/, unsigned /*count*/) {
    if (stand_in->is_gone) {
        errno = ENODEV;
        return -1;
    }
    eventfd_t falls = 0;
    return ::eventfd_read(stand_in->event, &falls) == 0 ? static_cast<int>(falls) : -1;
}
}

namespace octoskin::linux_port {
namespace {

class GpioLinesTest : public testing::Test {
  protected:
    GpioLinesTest() { stand_in = &line_; }
    ~GpioLinesTest() override { ::close(line_.event); }
    void fall() const { ASSERT_EQ(::eventfd_write(line_.event, 1), 0); }

    StandIn line_;
    const std::vector<LineName> names_{{.chip = "gpiochip0", .offset = 17}};
};

TEST_F(GpioLinesTest, a_fall_is_taken_once_and_the_line_is_listened_to_again) {
    auto inputs = DataReadyInputs::request(names_).value();
    EXPECT_GE(inputs.descriptor(0), 0);
    EXPECT_EQ(inputs.descriptor(1), -1);
    fall();
    inputs.on_readable(0);
    EXPECT_EQ(inputs.descriptor(0), -1) << "until the core asks";
    EXPECT_TRUE(inputs.take_fall(0));
    EXPECT_FALSE(inputs.take_fall(0));
    EXPECT_GE(inputs.descriptor(0), 0);
    EXPECT_TRUE(inputs.gone().empty());
}

// Its descriptor is readable for good, which would take a whole processor.
TEST_F(GpioLinesTest, a_line_whose_chip_is_gone_is_listened_to_no_more_and_named) {
    auto inputs = DataReadyInputs::request(names_).value();
    fall();
    line_.is_gone = true;
    ASSERT_TRUE(is_readable(inputs.descriptor(0)));
    inputs.on_readable(0);
    EXPECT_EQ(inputs.descriptor(0), -1);
    EXPECT_FALSE(inputs.take_fall(0));
    EXPECT_EQ(inputs.descriptor(0), -1);
    EXPECT_EQ(inputs.gone(), std::vector<std::string>{"gpiochip0:17"});
}

TEST_F(GpioLinesTest, at_the_end_all_are_low_or_the_refused_ones_are_counted) {
    auto outputs = XshutOutputs::request(names_).value();
    outputs.set(0, true);
    EXPECT_EQ(line_.value, 1);
    EXPECT_EQ(outputs.set_all_low(), 0U);
    EXPECT_EQ(line_.value, 0);
    line_.refuses = true;
    EXPECT_EQ(outputs.set_all_low(), 1U);
    EXPECT_EQ(outputs.failures(), 0U) << "those of the node are counted, not those of its end";
}

}  // namespace
}  // namespace octoskin::linux_port
