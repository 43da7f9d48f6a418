// Access to registers by name. Each peripheral has a table of register offsets and bit fields under ST's
// names. Code uses an entry by its text, which is looked up at compile time:
//
//     rcc.set("CR.HSEON", 1);
//
// A misspelt name does not compile, and no string reaches the image. A test on the PC compares every entry
// with ST's SVD file.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/port/stm32g4/registers/memory_access.hpp"

namespace octoskin::stm32g4 {

struct Instance {
    std::string_view name;
    Address base = 0;
};

/// `count` consecutive registers of 4 bytes, for a name that ends in '#': "ISER#" is ISER0, ISER1, ...
struct RegisterEntry {
    std::string_view name;
    std::uint16_t offset = 0;
    std::uint8_t count = 1;
};

/// `count` fields of the same width side by side, for a name that ends in '#', numbered from `first`.
struct FieldEntry {
    std::string_view name;  ///< "REGISTER.FIELD"
    std::uint8_t lsb = 0;
    std::uint8_t width = 1;
    std::uint8_t count = 1;
    std::uint8_t first = 0;
};

/// Never defined: a call at compile time is the error message.
void no_such_name_in_the_register_map();

template <class Map>
consteval std::uint16_t offset_of(std::string_view name) {
    for (const RegisterEntry& entry : Map::kRegisters) {
        if (entry.name == name) return entry.offset;
    }
    no_such_name_in_the_register_map();
    return 0;
}

/// A register of a peripheral with this map.
template <class Map>
struct Register {
    std::uint16_t offset;

    consteval Register(const char* name) : offset(offset_of<Map>(name)) {}
    /// The n-th of several.
    [[nodiscard]] constexpr Register operator[](std::uint32_t n) const {
        return Register(static_cast<std::uint16_t>(offset + 4 * n));
    }

    /// For `operator[]` only; GCC 12 rejects it if it is private.
    constexpr explicit Register(std::uint16_t register_offset) : offset(register_offset) {}
};

/// A bit field of a register. Nearly always known at compile time, so that its operations become a constant
/// or one instruction. They are always inline, since -Os would not inline them.
template <class Map>
struct Field {
    Register<Map> in;
    std::uint8_t lsb;
    std::uint8_t width;

    consteval Field(const char* name) : Field(entry_of(name), name) {}

    [[nodiscard, gnu::always_inline]] constexpr std::uint32_t mask() const {
        return (width >= 32 ? 0xFFFF'FFFFU : (1U << width) - 1U) << lsb;
    }
    /// `value` shifted to its place; excess bits are cut off.
    [[nodiscard, gnu::always_inline]] constexpr std::uint32_t operator()(std::uint32_t value) const {
        return (value << lsb) & mask();
    }
    [[nodiscard, gnu::always_inline]] constexpr std::uint32_t of(std::uint32_t word) const {
        return (word & mask()) >> lsb;
    }
    /// The n-th of several.
    [[nodiscard]] constexpr Field operator[](std::uint32_t n) const {
        return Field(in, static_cast<std::uint8_t>(lsb + n * width), width);
    }
    /// The same bits in the n-th of several registers.
    [[nodiscard]] constexpr Field in_register(std::uint32_t n) const { return Field(in[n], lsb, width); }

  private:
    constexpr Field(Register<Map> where, std::uint8_t bit, std::uint8_t bits)
        : in(where), lsb(bit), width(bits) {}
    consteval Field(const FieldEntry& entry, std::string_view name)
        : in(offset_of<Map>(name.substr(0, name.find('.')))), lsb(entry.lsb), width(entry.width) {}

    [[nodiscard]] static consteval FieldEntry entry_of(std::string_view name) {
        for (const FieldEntry& entry : Map::kFields) {
            if (entry.name == name) return entry;
        }
        no_such_name_in_the_register_map();
        return {};
    }
};

/// One peripheral in the address space.
template <class Map>
class Peripheral {
  public:
    /// By its name in the map's table.
    consteval explicit Peripheral(const char* name) : base_(base_of(name)) {}

    [[nodiscard]] std::uint32_t read(Register<Map> where) const { return load(base_ + where.offset); }
    void write(Register<Map> where, std::uint32_t value) const { store(base_ + where.offset, value); }

    [[nodiscard, gnu::always_inline]] std::uint32_t get(Field<Map> field) const {
        return field.of(read(field.in));
    }
    [[nodiscard, gnu::always_inline]] bool is_set(Field<Map> field) const { return get(field) != 0; }
    /// Read, modify, write: not for registers that an interrupt also changes.
    [[gnu::always_inline]] void set(Field<Map> field, std::uint32_t value) const {
        write(field.in, (read(field.in) & ~field.mask()) | field(value));
    }

    [[nodiscard]] constexpr Address base() const { return base_; }

  private:
    [[nodiscard]] static consteval Address base_of(std::string_view name) {
        for (const Instance& instance : Map::kInstances) {
            if (instance.name == name) return instance.base;
        }
        no_such_name_in_the_register_map();
        return 0;
    }

    Address base_;
};

}  // namespace octoskin::stm32g4
