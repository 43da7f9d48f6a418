// The decoder reads its payload and not a byte beyond, with memory on both sides that may not be read.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <random>
#include <span>

#include "common/wire/codec.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::test {
namespace {

/// One page that may be read between two that may not.
class GuardedPage {
  public:
    GuardedPage() : size_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))) {
        void* pages = mmap(nullptr, 3 * size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        EXPECT_NE(pages, MAP_FAILED);
        begin_ = static_cast<std::uint8_t*>(pages);
        EXPECT_EQ(mprotect(begin_ + size_, size_, PROT_READ | PROT_WRITE), 0);
    }
    GuardedPage(const GuardedPage&) = delete;
    GuardedPage& operator=(const GuardedPage&) = delete;
    ~GuardedPage() { munmap(begin_, 3 * size_); }

    std::span<const std::uint8_t> at_start(const Payload& bytes) { return copy(bytes, begin_ + size_); }
    std::span<const std::uint8_t> at_end(const Payload& bytes) {
        return copy(bytes, begin_ + 2 * size_ - bytes.size());
    }

  private:
    static std::span<const std::uint8_t> copy(const Payload& bytes, std::uint8_t* to) {
        std::ranges::copy(bytes, to);
        return {to, bytes.size()};
    }
    std::size_t size_;
    std::uint8_t* begin_ = nullptr;
};

TEST(CodecBounds, no_byte_outside_the_payload_is_ever_read) {
    GuardedPage page;
    std::mt19937 random(4);
    for (std::uint32_t can_id = 0; can_id < 2048; can_id += 31) {
        for (std::size_t length = 0; length <= 64; ++length) {
            Payload payload(length);
            std::ranges::generate(payload, [&random] { return static_cast<std::uint8_t>(random()); });
            if (length > 0) {
                payload[0] = static_cast<std::uint8_t>((payload[0] & 0xF8U) | 1U);
            }
            sign(can_id, payload, checksum_len_of(can_id));
            for (const bool is_fd : {false, true}) {
                static_cast<void>(wire::decode(can_id, is_fd, page.at_start(payload)));
                static_cast<void>(wire::decode(can_id, is_fd, page.at_end(payload)));
            }
        }
    }
    for (const MessageCase& example : all_message_cases()) {
        const wire::CanFrame good = encode(example.message, example.node_id);
        EXPECT_TRUE(wire::decode(good.can_id, good.is_fd, page.at_start(payload_of(good)))) << good.can_id;
        EXPECT_TRUE(wire::decode(good.can_id, good.is_fd, page.at_end(payload_of(good)))) << good.can_id;
    }
}

}  // namespace
}  // namespace octoskin::test
