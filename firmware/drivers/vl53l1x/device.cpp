// Runs the tables of method.hpp: stage by stage, transfer by transfer. Each transfer has a deadline.
#include "firmware/drivers/vl53l1x/device.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "firmware/drivers/i2c/transfer_time.hpp"

namespace octoskin::vl53l1x {
namespace {

// Other devices hold the bus for one transfer at a time. A bus that stays busy for this long has failed.
constexpr Microseconds kBusAwaitedMax{250'000};
// A bus ends every transfer at its deadline. A transfer that is still pending this much later is given up.
constexpr Microseconds kDeadlineGrace{5'000};

}  // namespace

Progress Device::poll(NodeTime now) {
    if (is_in_flight_) collect(now);
    if (progress_ == Progress::busy && !is_in_flight_) proceed(now);
    const Progress reported = progress_;
    if (reported == Progress::done || reported == Progress::failed) progress_ = Progress::idle;
    return reported;
}

std::optional<NodeTime> Device::wake_time() const noexcept {
    return progress_ == Progress::busy && !is_in_flight_ ? resume_at_ : std::nullopt;
}

void Device::begin(std::span<const Stage> stages) {
    assert(!is_busy());
    stages_ = stages;
    stage_ = 0;
    step_ = 0;
    step_count_ = 0;
    resume_at_.reset();
    bus_awaited_since_.reset();
    was_retried_ = false;
    transfers_done_ = 0;
    progress_ = Progress::busy;
}

void Device::begin_refused() {
    begin({});
    fail(Error::unsupported_config);
}

void Device::proceed(NodeTime now) {
    while (progress_ == Progress::busy && step_ == step_count_) {  // at most one iteration per stage
        if (stage_ == stages_.size()) {
            progress_ = Progress::done;
        } else {
            enter_stage(now);
        }
    }
    if (progress_ != Progress::busy) return;
    if (resume_at_ && !is_reached(*resume_at_, now)) return;
    submit(now);
}

void Device::enter_stage(NodeTime now) {
    const Stage& stage = stages_[stage_++];
    stage_deadline_ = now + Microseconds{stage.within_us};
    step_ = 0;
    step_count_ = 0;
    stage.line_up(*this);
}

void Device::repeat_stage(NodeTime now) {
    const Stage& stage = stages_[stage_ - 1];
    if (is_reached(stage_deadline_, now)) {
        fail(stage.otherwise);
        return;
    }
    resume_at_ = now + Microseconds{stage.every_us};
    step_ = 0;
    step_count_ = 0;
    stage.line_up(*this);
}

void Device::submit(NodeTime now) {
    if (bus_.is_busy()) {
        if (!bus_awaited_since_) bus_awaited_since_ = now;
        if (elapsed(*bus_awaited_since_, now) >= kBusAwaitedMax) {
            transfer_error_ = i2c::TransferError::timeout;
            fail(Error::bus_error);
        }
        return;
    }
    resume_at_.reset();
    bus_awaited_since_.reset();
    const i2c::Transfer transfer = compose(steps_[step_]);
    submitted_ = now;
    transfer_deadline_ =
        now + i2c::time_limit(transfer, options_.i2c_hz, Microseconds{options_.i2c_lateness_us});
    is_in_flight_ = true;
    bus_.submit(transfer, now, transfer_deadline_);
}

i2c::Transfer Device::compose(const Step& step) {
    const auto index = static_cast<reg::Index>(step.index + transfers_done_);
    sent_[0] = static_cast<std::uint8_t>(index >> 8U);
    sent_[1] = static_cast<std::uint8_t>(index & 0xFFU);
    const std::span sent(sent_);
    switch (step.kind) {
        case Step::Kind::read:
            return {live_address_, sent.first(kIndexBytes), std::span(answer_).first(step.count)};
        case Step::Kind::write:
            std::copy_n(step.bytes.begin(), step.count, sent.begin() + kIndexBytes);
            break;
        case Step::Kind::write_defaults:
            for (std::uint8_t i = 0; i < step.count; ++i) {
                sent_[kIndexBytes + i] =
                    default_configuration(static_cast<reg::Index>(index + i),
                                          {.is_io_2v8 = options_.is_io_2v8,
                                           .is_interrupt_active_low = options_.is_interrupt_active_low});
            }
            break;
    }
    return {live_address_, sent.first(kIndexBytes + step.count), {}};
}

void Device::collect(NodeTime now) {
    switch (bus_.poll(now)) {
        case i2c::TransferState::pending:
            if (elapsed(transfer_deadline_, now) < kDeadlineGrace) return;
            is_in_flight_ = false;
            transfer_error_ = i2c::TransferError::timeout;
            fail(Error::bus_error);
            return;
        case i2c::TransferState::done:
            is_in_flight_ = false;
            on_transfer_done(now);
            return;
        case i2c::TransferState::failed:
            is_in_flight_ = false;
            on_transfer_failed(bus_.error(), now);
            return;
        case i2c::TransferState::idle:  // `recover` dropped the transfer
            is_in_flight_ = false;
            on_transfer_failed(i2c::TransferError::timeout, now);
            return;
    }
}

void Device::on_transfer_done(NodeTime now) {
    was_retried_ = false;
    const Step& step = steps_[step_];
    if (step.kind != Step::Kind::read) {
        const auto index = static_cast<reg::Index>(step.index + transfers_done_);
        read_back_.note(index, std::span(sent_).subspan(kIndexBytes, step.count));
    }
    if (++transfers_done_ < step.transfers) return;
    transfers_done_ = 0;
    ++step_;
    if (step.judge != nullptr) follow(step.judge(*this, now), now);
}

void Device::follow(NextStep verdict, NodeTime now) {
    switch (verdict) {
        case NextStep::proceed:
            return;
        case NextStep::repeat_stage:
            repeat_stage(now);
            return;
        case NextStep::end:
            if (progress_ == Progress::busy) progress_ = Progress::done;
            return;
    }
}

void Device::on_transfer_failed(i2c::TransferError error, NodeTime now) {
    const bool is_refused = error == i2c::TransferError::nack_address;
    const Judge on_refused = is_refused ? steps_[step_].on_refused : nullptr;
    transfer_error_ = error;
    if (on_refused != nullptr) {
        follow(on_refused(*this, now), now);
        return;
    }
    count_i2c_error();
    if (!was_retried_) {
        was_retried_ = true;  // the step is unchanged, and `proceed` submits it again
        return;
    }
    fail(is_refused ? Error::no_answer : Error::bus_error);
}

void Device::count_i2c_error() noexcept {
    if (i2c_error_count_ < std::numeric_limits<std::uint16_t>::max()) ++i2c_error_count_;
}

Device::NextStep Device::fail(Error error) {
    error_ = error;
    progress_ = Progress::failed;
    return NextStep::end;
}

void Device::line_up(const Step& step) {
    assert(step_count_ < kStepsMax);
    steps_[step_count_++] = step;
}

void Device::read(reg::Index index, std::uint8_t count, Judge judge) {
    assert(count >= 1 && count <= answer_.size());
    line_up({.kind = Step::Kind::read, .index = index, .count = count, .judge = judge});
}

void Device::write8(reg::Index index, std::uint8_t value, Judge judge) {
    line_up({.kind = Step::Kind::write, .index = index, .count = 1, .bytes = {value}, .judge = judge});
}

void Device::write16(reg::Index index, std::uint16_t value, Judge judge) {
    const auto high = static_cast<std::uint8_t>(value >> 8U);
    const auto low = static_cast<std::uint8_t>(value & 0xFFU);
    line_up({.kind = Step::Kind::write, .index = index, .count = 2, .bytes = {high, low}, .judge = judge});
}

void Device::write32(reg::Index index, std::uint32_t value) {
    Step step{.kind = Step::Kind::write, .index = index, .count = 4};
    for (std::uint8_t& byte : step.bytes) {
        byte = static_cast<std::uint8_t>(value >> 24U);
        value <<= 8U;
    }
    line_up(step);
}

ResultBlock Device::answered_block() const {
    ResultBlock block{};
    std::copy_n(answer_.begin(), block.size(), block.begin());
    return block;
}

std::uint16_t Device::answer16() const {
    return static_cast<std::uint16_t>((answer_[0] << 8U) | answer_[1]);
}

}  // namespace octoskin::vl53l1x
