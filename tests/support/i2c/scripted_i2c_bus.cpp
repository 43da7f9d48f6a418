#include "tests/support/i2c/scripted_i2c_bus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace octoskin::test {
namespace {

std::string describe(const i2c::Transfer& transfer) {
    std::ostringstream text;
    text << std::hex << std::uppercase << std::setfill('0') << "address " << int{transfer.address}
         << ", write";
    for (const std::uint8_t byte : transfer.write) text << ' ' << std::setw(2) << int{byte};
    text << std::dec << ", read " << transfer.read.size();
    return text.str();
}

bool is_as_expected(const TraceEntry& expected, const i2c::Transfer& transfer) {
    return expected.address == transfer.address && std::ranges::equal(expected.write, transfer.write) &&
           expected.read.size() == transfer.read.size();
}

}  // namespace

ScriptedI2cBus::~ScriptedI2cBus() {
    for (; next_ < script_.size(); ++next_) ADD_FAILURE() << "never asked for: " << script_[next_].text;
}

void ScriptedI2cBus::expect(std::string_view script) {
    for (TraceEntry& entry : parse_trace(script)) script_.push_back(std::move(entry));
}

void ScriptedI2cBus::expect_failure(std::string_view entry, i2c::TransferError error) {
    for (TraceEntry& expected : parse_trace(entry)) {
        expected.error = error;
        script_.push_back(std::move(expected));
    }
}

void ScriptedI2cBus::submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) {
    EXPECT_FALSE(is_in_flight_) << "submitted while busy: " << describe(transfer);
    is_in_flight_ = true;
    transfer_ = transfer;
    last_time_limit_ = elapsed(now, deadline);
    if (next_ == script_.size()) {
        ADD_FAILURE() << "after the script's end: " << describe(transfer);
    } else if (!is_as_expected(script_[next_], transfer)) {
        ADD_FAILURE() << "expected '" << script_[next_].text << "', got " << describe(transfer);
        next_ = script_.size();
    }
}

i2c::TransferState ScriptedI2cBus::poll(NodeTime) {
    if (!is_in_flight_) return i2c::TransferState::idle;
    is_in_flight_ = false;
    if (next_ == script_.size()) {
        error_ = i2c::TransferError::bus_stuck;
        return i2c::TransferState::failed;
    }
    const TraceEntry& entry = script_[next_++];
    if (entry.error) {
        error_ = *entry.error;
        return i2c::TransferState::failed;
    }
    std::ranges::transform(entry.read, transfer_.read.begin(),
                           [](const auto& byte) { return byte.value_or(0); });
    return i2c::TransferState::done;
}

bool ScriptedI2cBus::recover() {
    is_in_flight_ = false;
    return true;
}

}  // namespace octoskin::test
