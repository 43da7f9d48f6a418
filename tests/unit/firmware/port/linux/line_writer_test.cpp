// Lines into a pipe that nothing reads for a while.
#include "firmware/port/linux/line_writer.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <memory>
#include <string>

namespace octoskin::linux_port {
namespace {

using namespace std::chrono_literals;

class LineWriterTest : public testing::Test {
  protected:
    LineWriterTest() { EXPECT_EQ(::pipe2(ends_.data(), O_CLOEXEC), 0); }
    ~LineWriterTest() override {
        std::signal(SIGPIPE, SIG_IGN);
        ::close(ends_[0]);  // a write that hangs ends with it
        writer_.reset();
        ::close(ends_[1]);
    }
    void fill() {
        ::fcntl(ends_[1], F_SETFL, O_NONBLOCK);
        const std::string filling(4096, '.');
        while (::write(ends_[1], filling.data(), filling.size()) > 0) ++filled_;
        ::fcntl(ends_[1], F_SETFL, 0);
    }
    /// Until `end` came; without what filled the pipe.
    [[nodiscard]] std::string read_until(const std::string& end) const {
        std::string text;
        std::array<char, 4096> bytes{};
        while (text.find(end) == std::string::npos) {
            const ssize_t count = ::read(ends_[0], bytes.data(), bytes.size());
            if (count <= 0) break;
            text.append(bytes.data(), static_cast<std::size_t>(count));
        }
        return text.substr(filled_ * 4096);
    }

    std::array<int, 2> ends_{};
    std::size_t filled_ = 0;
    std::unique_ptr<LineWriter> writer_;
};

TEST_F(LineWriterTest, writes_lines_in_their_order) {
    writer_ = std::make_unique<LineWriter>(ends_[1]);
    writer_->add("a\n");
    writer_->add("b\n");
    EXPECT_EQ(read_until("b\n"), "a\nb\n");
}

TEST_F(LineWriterTest, waits_for_no_reader_and_tells_how_many_lines_it_dropped) {
    fill();
    writer_ = std::make_unique<LineWriter>(ends_[1], 50ms);
    const auto begun = std::chrono::steady_clock::now();
    for (int i = 0; i < 5000; ++i) writer_->add(std::to_string(i) + "\n");
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 5s);
    const std::string text = read_until(" lines are left out here");
    EXPECT_EQ(text.rfind("0\n1\n2\n", 0), 0U) << text.substr(0, 20);
    // One more waits than have room, if the thread has taken the first by then.
    EXPECT_TRUE(text.find("\n998\n") != std::string::npos && text.find("\n1001\n") == std::string::npos);
}

TEST_F(LineWriterTest, writes_what_waits_before_it_ends_and_leaves_a_write_that_hangs_behind) {
    writer_ = std::make_unique<LineWriter>(ends_[1]);
    for (int i = 0; i < 100; ++i) writer_->add(std::to_string(i) + "\n");
    writer_.reset();
    EXPECT_NE(read_until("99\n").find("98\n"), std::string::npos);
    fill();
    writer_ = std::make_unique<LineWriter>(ends_[1], 50ms);
    writer_->add("a line\n");
    const auto begun = std::chrono::steady_clock::now();
    writer_.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
}

}  // namespace
}  // namespace octoskin::linux_port
