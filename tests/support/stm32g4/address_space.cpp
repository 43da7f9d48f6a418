#include "tests/support/stm32g4/address_space.hpp"

#include <cassert>

#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/registers/timer.hpp"

namespace octoskin::test {

namespace {
AddressSpace* current = nullptr;
const Address kCounter = stm32g4::tim2.base() + stm32g4::Register<stm32g4::TimerMap>("CNT").offset;
}  // namespace

AddressSpace::AddressSpace() {
    assert(current == nullptr);
    current = this;
    before_read(kCounter, [](std::uint32_t& count) { ++count; });
}

AddressSpace::~AddressSpace() {
    current = nullptr;
}

void AddressSpace::before_read(Address address, std::function<void(std::uint32_t&)> action) {
    readers_[address] = std::move(action);
}

void AddressSpace::on_write(Address address, std::function<void(std::uint32_t&, std::uint32_t)> action) {
    writers_[address] = std::move(action);
}

std::uint32_t& AddressSpace::time_us() {
    return words_[kCounter];
}

std::vector<std::uint32_t> AddressSpace::written_to(Address address) const {
    std::vector<std::uint32_t> values;
    for (const Write& write : writes_) {
        if (write.address == address) values.push_back(write.value);
    }
    return values;
}

std::uint32_t AddressSpace::read(Address address) {
    std::uint32_t& word = words_[address];
    if (const auto reader = readers_.find(address); reader != readers_.end()) reader->second(word);
    return word;
}

void AddressSpace::write(Address address, std::uint32_t value) {
    writes_.push_back({address, value});
    std::uint32_t& word = words_[address];
    const auto writer = writers_.find(address);
    if (writer != writers_.end()) {
        writer->second(word, value);
    } else {
        word = value;
    }
}

}  // namespace octoskin::test

// The definitions that the port is linked with on the PC.
namespace octoskin::stm32g4 {

std::uint32_t load(Address address) {
    assert(test::current != nullptr);
    return test::current->read(address);
}
void store(Address address, std::uint32_t value) {
    assert(test::current != nullptr);
    test::current->write(address, value);
}

namespace cpu {
void mask_interrupts() {}
void unmask_interrupts() {}
void wait_for_interrupt() {}
void barrier() {}
void spin(std::uint32_t) {}
}  // namespace cpu

}  // namespace octoskin::stm32g4
