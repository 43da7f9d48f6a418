#include "tests/support/target/semihosting.hpp"

#include <array>
#include <cstdint>

namespace octoskin::target {
namespace {

enum class Operation : std::uint32_t { write0 = 0x04, get_cmdline = 0x15, exit_extended = 0x20 };
constexpr std::uint32_t kApplicationExit = 0x20026;

std::uint32_t call(Operation operation, const volatile void* argument) {
    register std::uint32_t r0 asm("r0") = static_cast<std::uint32_t>(operation);
    register const volatile void* r1 asm("r1") = argument;
    asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

}  // namespace

void end_machine(int exit_code) {
    const std::array<std::uint32_t, 2> block{kApplicationExit, static_cast<std::uint32_t>(exit_code)};
    call(Operation::exit_extended, block.data());
    while (true) {
    }
}

void write_raw(const char* text) {
    call(Operation::write0, text);
}

char* command_line() {
    static std::array<char, 1024> text;
    struct Block {
        char* text;
        std::uint32_t text_len;
    } block{text.data(), text.size()};
    if (call(Operation::get_cmdline, &block) != 0) text[0] = '\0';
    return text.data();
}

}  // namespace octoskin::target
