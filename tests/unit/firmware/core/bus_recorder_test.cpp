// What the recorder of a bus keeps, how much of it, and what the black box makes of it.
#include "firmware/core/bus_recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <span>
#include <vector>

#include "firmware/core/black_box.hpp"

namespace octoskin::node {
namespace {

using i2c::TransferError;
using i2c::TransferState;

/// A bus that does as it is told.
class ObedientBus final : public i2c::Bus {
  public:
    std::optional<TransferError> next_error;
    std::uint8_t fills_with = 0;

    [[nodiscard]] bool is_busy() const override { return transfer_.has_value(); }
    void submit(const i2c::Transfer& transfer, NodeTime, NodeTime) override { transfer_ = transfer; }
    [[nodiscard]] TransferState poll(NodeTime) override {
        if (!transfer_) return TransferState::idle;
        std::ranges::fill(transfer_->read, fills_with);
        transfer_.reset();
        return next_error ? TransferState::failed : TransferState::done;
    }
    [[nodiscard]] TransferError error() const override { return *next_error; }
    bool recover() override {
        transfer_.reset();
        return true;
    }

  private:
    std::optional<i2c::Transfer> transfer_;
};

/// The oracle: a list of what was done.
struct Done {
    wire::TransferHeader header;
    std::vector<std::uint8_t> written;
    std::vector<std::uint8_t> read;
    [[nodiscard]] std::size_t bytes() const { return 8 + written.size() + read.size(); }
    friend bool operator==(const Done&, const Done&) = default;
};

std::vector<Done> parsed(std::span<const std::uint8_t> bytes) {
    const auto header = wire::decode_dump_header(bytes);
    EXPECT_TRUE(header);
    EXPECT_EQ(header->length + 2U, bytes.size());
    std::vector<Done> all;
    auto rest = bytes.subspan(wire::kDumpHeaderBytes);
    while (!rest.empty()) {
        const auto transfer = wire::take_transfer(rest);
        EXPECT_TRUE(transfer);
        if (!transfer) break;
        all.push_back({transfer->header,
                       {transfer->written.begin(), transfer->written.end()},
                       {transfer->read.begin(), transfer->read.end()}});
    }
    return all;
}

std::vector<std::uint8_t> dump_of(const BusRecorder& recorder) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < recorder.dump_size(); ++i) bytes.push_back(recorder.dump_byte(i));
    return bytes;
}

class BusRecorderTest : public testing::Test {
  protected:
    Done transfer(std::size_t written, std::size_t read, std::optional<TransferError> error = {}) {
        std::vector<std::uint8_t> out(written);
        for (auto& byte : out) byte = static_cast<std::uint8_t>(random_());
        std::vector<std::uint8_t> in(read);
        bus_.next_error = error;
        bus_.fills_with = static_cast<std::uint8_t>(random_());
        const auto address = static_cast<i2c::Address>(random_() % 128);
        now_ = now_ + Microseconds{137};
        recorder_.submit({.address = address, .write = out, .read = in}, now_, now_ + Microseconds{2'000});
        EXPECT_TRUE(recorder_.is_busy());
        EXPECT_EQ(recorder_.poll(now_ + Microseconds{90}),
                  error ? TransferState::failed : TransferState::done);
        const auto outcome = error ? static_cast<wire::TransferOutcome>(static_cast<int>(*error) + 1)
                                   : wire::TransferOutcome::done;
        return {{.start = now_,
                 .address = address,
                 .outcome = outcome,
                 .written = static_cast<std::uint8_t>(written),
                 .read_asked = static_cast<std::uint8_t>(read)},
                out,
                error ? std::vector<std::uint8_t>{} : in};
    }
    std::mt19937 random_{7};
    ObedientBus bus_;
    BusRecorder recorder_{bus_};
    NodeTime now_{0xFFFF'FF00U};
};

TEST_F(BusRecorderTest, keeps_the_newest_64_transfers_and_at_most_1536_bytes_of_them) {
    std::deque<Done> expected;
    for (int i = 0; i < 5'000; ++i) {
        const bool is_long = random_() % 20 == 0;
        const std::size_t written = 2 + random_() % (is_long ? 92 : 4);
        const std::size_t read = random_() % 2 == 0 ? 0 : 1 + random_() % 17;
        std::optional<TransferError> error;
        if (random_() % 10 == 0) error = static_cast<TransferError>(random_() % 5);
        expected.push_back(transfer(written, read, error));
        const auto bytes = [&] {
            std::size_t sum = 0;
            for (const Done& done : expected) sum += done.bytes();
            return sum;
        };
        while (expected.size() > 64 || bytes() > 1'536) expected.pop_front();
        if (i % 97 != 0) continue;
        recorder_.freeze(now_);
        ASSERT_EQ(parsed(dump_of(recorder_)), std::vector<Done>(expected.begin(), expected.end())) << i;
        recorder_.thaw();
    }
}

TEST_F(BusRecorderTest, records_nothing_while_it_is_frozen_and_passes_everything_on) {
    const Done first = transfer(3, 0);
    recorder_.freeze(NodeTime{4711});
    transfer(2, 17);
    EXPECT_EQ(parsed(dump_of(recorder_)), std::vector<Done>{first});
    EXPECT_EQ(wire::decode_dump_header(dump_of(recorder_))->frozen, NodeTime{4711});
    recorder_.thaw();
    const Done third = transfer(2, 1);
    recorder_.freeze(now_);
    EXPECT_EQ(parsed(dump_of(recorder_)), (std::vector<Done>{first, third}));
}

TEST_F(BusRecorderTest, records_a_transfer_that_was_given_up_for_a_recovery_as_timed_out) {
    const std::vector<std::uint8_t> out = {0, 0x31};
    std::vector<std::uint8_t> in(1);
    recorder_.submit({.address = 0x30, .write = out, .read = in}, now_, now_);
    EXPECT_TRUE(recorder_.recover());
    EXPECT_FALSE(recorder_.is_busy());
    recorder_.freeze(now_);
    const auto all = parsed(dump_of(recorder_));
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].header.outcome, wire::TransferOutcome::timeout);
}

TEST_F(BusRecorderTest, calls_a_transfer_overdue_100_ms_after_its_deadline) {
    const std::vector<std::uint8_t> out = {0, 0x31, 0};
    recorder_.submit({.address = 0x30, .write = out, .read = {}}, now_, now_ + Microseconds{1'500});
    EXPECT_FALSE(recorder_.is_overdue(now_ + Microseconds{101'499}));
    EXPECT_TRUE(recorder_.is_overdue(now_ + Microseconds{101'500}));
    EXPECT_EQ(recorder_.poll(now_), TransferState::done);
    EXPECT_FALSE(recorder_.is_overdue(now_ + Microseconds{200'000}));
}

class BlackBoxTest : public testing::Test {
  protected:
    BlackBoxTest() {
        for (std::size_t i = 0; i < buses_.size(); ++i) recorders_.at(i).emplace(buses_.at(i));
        for (std::uint8_t value = 0; value < 20; ++value) {
            for (auto& recorder : recorders_) {
                if (!recorder) continue;
                const std::vector<std::uint8_t> out = {0, value, value};
                recorder->submit({.address = value, .write = out, .read = {}}, now_, now_);
                EXPECT_EQ(recorder->poll(now_), TransferState::done);
            }
        }
    }
    /// All pieces that come within `ms`, when asked every millisecond.
    std::vector<wire::BlackBox> pieces_within(int ms) {
        std::vector<wire::BlackBox> pieces;
        for (int i = 0; i < ms; ++i) {
            black_box_.update(now_);
            if (const auto piece = black_box_.due()) {
                pieces.push_back(*piece);
                black_box_.sent(now_);
            }
            now_ = now_ + Microseconds{1'000};
        }
        return pieces;
    }
    std::array<ObedientBus, 2> buses_;
    BusRecorders recorders_;
    const Policy policy_{};
    BlackBox black_box_{recorders_, policy_};
    NodeTime now_{0xFFFF'FFFFU - 500'000U};
};

TEST_F(BlackBoxTest, sends_nothing_unless_something_failed_or_somebody_asked) {
    EXPECT_TRUE(pieces_within(1'000).empty());
    EXPECT_FALSE(black_box_.wake_time(now_));
}

TEST_F(BlackBoxTest, sends_the_whole_dump_at_20_pieces_a_second_and_thaws_the_recorder) {
    black_box_.on_fault(1, now_);
    const auto pieces = pieces_within(10'000);
    // Header and 20 transfers of 8 + 3 bytes: 226, so 46 pieces.
    ASSERT_EQ(pieces.size(), 46U);
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        EXPECT_EQ(pieces[i].bus, 1);
        EXPECT_EQ(pieces[i].dump, 0);
        EXPECT_EQ(pieces[i].index, i);
        bytes.insert(bytes.end(), pieces[i].bytes.begin(), pieces[i].bytes.end());
    }
    bytes.resize(226);
    EXPECT_EQ(parsed(bytes).size(), 20U);
    EXPECT_FALSE(recorders_[1]->is_frozen());
    black_box_.on_request(0, now_);
    EXPECT_EQ(pieces_within(1'000).size(), 20U);
}

TEST_F(BlackBoxTest, sends_one_dump_after_the_other_and_each_as_it_was_when_it_was_wanted) {
    black_box_.on_fault(1, now_);
    black_box_.on_request(0, now_);
    EXPECT_TRUE(recorders_[0]->is_frozen());
    EXPECT_TRUE(recorders_[1]->is_frozen());
    const auto pieces = pieces_within(10'000);
    ASSERT_EQ(pieces.size(), 92U);
    EXPECT_NE(pieces.front().bus, pieces.back().bus);
    EXPECT_EQ(pieces.back().dump, 1);
    for (std::size_t i = 0; i < pieces.size(); ++i) EXPECT_EQ(pieces[i].index, i % 46);
}

TEST_F(BlackBoxTest, ends_the_dump_under_way_before_it_begins_one_of_any_other_bus) {
    for (const std::uint8_t first : {std::uint8_t{1}, std::uint8_t{0}}) {
        const auto second = static_cast<std::uint8_t>(1U - first);
        black_box_.on_request(first, now_);
        auto pieces = pieces_within(1'000);
        ASSERT_EQ(pieces.size(), 20U);
        black_box_.on_request(second, now_);
        const auto rest = pieces_within(10'000);
        pieces.insert(pieces.end(), rest.begin(), rest.end());
        ASSERT_EQ(pieces.size(), 92U);
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            ASSERT_EQ(pieces[i].bus, i < 46 ? first : second) << i;
            ASSERT_EQ(pieces[i].index, i % 46);
            ASSERT_EQ(pieces[i].dump, (pieces[0].dump + i / 46) % 4);
        }
        EXPECT_FALSE(recorders_[0]->is_frozen() || recorders_[1]->is_frozen());
    }
}

TEST_F(BlackBoxTest, sends_at_most_one_dump_a_minute_for_faults_and_always_one_for_an_order) {
    black_box_.on_fault(1, now_);
    EXPECT_EQ(pieces_within(10'000).size(), 46U);
    black_box_.on_fault(1, now_);
    EXPECT_TRUE(pieces_within(10'000).empty());
    black_box_.on_request(1, now_);
    EXPECT_EQ(pieces_within(10'000).size(), 46U);
    static_cast<void>(pieces_within(30'000));
    black_box_.on_fault(1, now_);
    EXPECT_EQ(pieces_within(10'000).size(), 46U);
}

// Times are compared modulo 2^32 us: 36 to 71 minutes later what was looks like what will be.
TEST_F(BlackBoxTest, sends_the_dump_of_a_fault_however_long_ago_the_last_one_was) {
    for (const int minutes : {36, 50, 70, 72}) {
        black_box_.on_fault(1, now_);
        EXPECT_EQ(pieces_within(10'000).size(), 46U) << minutes;
        for (int minute = 0; minute < minutes; ++minute) {
            now_ = now_ + Microseconds{60'000'000};
            black_box_.update(now_);
        }
    }
}

TEST_F(BlackBoxTest, goes_on_at_once_with_a_dump_that_nobody_took_for_long) {
    black_box_.on_fault(1, now_);
    EXPECT_EQ(pieces_within(1'000).size(), 20U);
    for (int minute = 0; minute < 40; ++minute) {
        now_ = now_ + Microseconds{60'000'000};
        black_box_.update(now_);
    }
    EXPECT_EQ(black_box_.wake_time(now_), now_);
    EXPECT_EQ(pieces_within(2'000).size(), 26U);
}

TEST_F(BlackBoxTest, has_nothing_of_a_bus_that_is_not_there) {
    black_box_.on_request(3, now_);
    EXPECT_TRUE(pieces_within(1'000).empty());
}

}  // namespace
}  // namespace octoskin::node
