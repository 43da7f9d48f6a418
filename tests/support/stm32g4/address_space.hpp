// The chip's address space for tests: words that keep the written value, and registers with effects. Linked
// in place of the real one; one object at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <type_traits>
#include <vector>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::test {

using stm32g4::Address;

class AddressSpace {
  public:
    struct Write {
        Address address = 0;
        std::uint32_t value = 0;
        friend bool operator==(const Write&, const Write&) = default;
    };

    AddressSpace();
    ~AddressSpace();
    AddressSpace(const AddressSpace&) = delete;
    AddressSpace& operator=(const AddressSpace&) = delete;

    /// A word without the side effects of reading it.
    [[nodiscard]] std::uint32_t& operator[](Address address) { return words_[address]; }
    template <class Map>
    [[nodiscard]] std::uint32_t& word(const stm32g4::Peripheral<Map>& peripheral,
                                      stm32g4::Register<std::type_identity_t<Map>> where) {
        return words_[peripheral.base() + where.offset];
    }

    /// Called before a read; may change the word.
    void before_read(Address address, std::function<void(std::uint32_t& word)> action);
    /// Called in place of a write.
    void on_write(Address address, std::function<void(std::uint32_t& word, std::uint32_t value)> action);

    /// Microseconds on timer 2, which reads one more each time: waiting takes time.
    [[nodiscard]] std::uint32_t& time_us();

    [[nodiscard]] const std::vector<Write>& writes() const { return writes_; }
    /// The values written to one address, in order.
    [[nodiscard]] std::vector<std::uint32_t> written_to(Address address) const;
    void forget_writes() { writes_.clear(); }

    [[nodiscard]] std::uint32_t read(Address address);
    void write(Address address, std::uint32_t value);

  private:
    std::map<Address, std::uint32_t> words_;
    std::map<Address, std::function<void(std::uint32_t&)>> readers_;
    std::map<Address, std::function<void(std::uint32_t&, std::uint32_t)>> writers_;
    std::vector<Write> writes_;
};

}  // namespace octoskin::test
