// The bytes of a dump, by hand after docs/protocol.md, and every dump that is cut short.
#include "common/wire/black_box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace octoskin::wire {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr TransferHeader kRead{.start = {0x8765'4321}, .address = 0x7F, .written = 2, .read_asked = 3};
const Bytes kReadBytes = {0x21, 0x43, 0x65, 0x87, 0x7F, 0, 2, 3, 0x01, 0x0F, 0xEA, 0xCC, 0x10};

template <std::size_t n>
Bytes bytes_of(const std::array<std::uint8_t, n>& bytes) {
    return {bytes.begin(), bytes.end()};
}

TEST(BlackBoxBytes, of_a_transfer_are_least_significant_first) {
    EXPECT_EQ(bytes_of(encode(kRead)), Bytes(kReadBytes.begin(), kReadBytes.begin() + 8));
    EXPECT_EQ(bytes_of(encode(TransferHeader{.start = {1},
                                             .address = 0x29,
                                             .outcome = TransferOutcome::bus_stuck,
                                             .written = 255,
                                             .read_asked = 254})),
              (Bytes{1, 0, 0, 0, 0x29, 5, 255, 254}));
}

TEST(BlackBoxBytes, of_a_dumps_head_are_least_significant_first_and_are_read_back) {
    const DumpHeader header{.length = 0xA1B2, .frozen = {0x8765'4321}};
    EXPECT_EQ(bytes_of(encode(header)), (Bytes{0xB2, 0xA1, 0x21, 0x43, 0x65, 0x87}));
    EXPECT_EQ(decode_dump_header(encode(header)).value(), header);
}

TEST(BlackBoxBytes, of_a_head_that_is_cut_short_or_claims_less_than_itself_are_refused) {
    const auto whole = encode(DumpHeader{.length = 4, .frozen = {7}});
    EXPECT_TRUE(decode_dump_header(whole).has_value());
    for (std::size_t size = 0; size < whole.size(); ++size) {
        EXPECT_EQ(decode_dump_header(std::span(whole).first(size)).error(), DumpError::truncated) << size;
    }
    for (std::uint16_t length = 0; length < 4; ++length) {
        EXPECT_EQ(decode_dump_header(encode(DumpHeader{.length = length, .frozen = {}})).error(),
                  DumpError::invalid_field)
            << length;
    }
}

TEST(BlackBoxBytes, of_transfers_are_taken_one_by_one) {
    Bytes two = kReadBytes;
    two.insert(two.end(), kReadBytes.begin(), kReadBytes.end());
    two[13 + 4] = 0x30;  // the second one's address
    std::span<const std::uint8_t> rest(two);
    const auto first = take_transfer(rest);
    ASSERT_TRUE(first.has_value());
    EXPECT_EQ(first->header, kRead);
    EXPECT_TRUE(std::ranges::equal(first->written, Bytes{0x01, 0x0F}));
    EXPECT_TRUE(std::ranges::equal(first->read, Bytes{0xEA, 0xCC, 0x10}));
    EXPECT_EQ(rest.size(), 13U);
    EXPECT_EQ(take_transfer(rest).value().header.address, 0x30);
    EXPECT_TRUE(rest.empty());
}

TEST(BlackBoxBytes, of_a_transfer_that_failed_hold_nothing_read) {
    Bytes failed(kReadBytes.begin(), kReadBytes.begin() + 10);
    for (std::uint8_t outcome = 1; outcome < kTransferOutcomes; ++outcome) {
        failed[5] = outcome;
        std::span<const std::uint8_t> rest(failed);
        const auto taken = take_transfer(rest);
        ASSERT_TRUE(taken.has_value()) << int{outcome};
        EXPECT_EQ(taken->header.outcome, static_cast<TransferOutcome>(outcome));
        EXPECT_EQ(taken->header.read_asked, 3);
        EXPECT_EQ(taken->written.size(), 2U);
        EXPECT_TRUE(taken->read.empty());
        EXPECT_TRUE(rest.empty());
    }
}

TEST(BlackBoxBytes, of_a_transfer_cut_short_anywhere_are_refused_and_not_taken) {
    for (std::size_t size = 0; size < kReadBytes.size(); ++size) {
        std::span<const std::uint8_t> rest = std::span(kReadBytes).first(size);
        EXPECT_EQ(take_transfer(rest).error(), DumpError::truncated) << size;
        EXPECT_EQ(rest.size(), size);
    }
}

TEST(BlackBoxBytes, of_an_address_or_outcome_that_does_not_exist_are_refused) {
    for (const auto& [position, first_bad] :
         std::array<std::pair<std::size_t, int>, 2>{{{4, 0x80}, {5, 6}}}) {
        for (int value = first_bad; value < 256; ++value) {
            Bytes bytes = kReadBytes;
            bytes[position] = static_cast<std::uint8_t>(value);
            std::span<const std::uint8_t> rest(bytes);
            EXPECT_EQ(take_transfer(rest).error(), DumpError::invalid_field) << position << ' ' << value;
        }
    }
}

TEST(BlackBoxBytes, name_each_outcome_as_its_enumerator) {
    const std::array<std::string, kTransferOutcomes + 1> names = {
        "done", "nack_address", "nack_data", "timeout", "arbitration_lost", "bus_stuck", "?"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        EXPECT_EQ(name(static_cast<TransferOutcome>(i)), names.at(i));
    }
}

}  // namespace
}  // namespace octoskin::wire
