// From reset to main, and from a fault to an exit code, on QEMU's mps2-an386. Registers: ARMv7-M Architecture
// Reference Manual (DDI 0403E), B3.2 "System Control Space" and B3.5 "Protected Memory System Architecture".
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/support/target/semihosting.hpp"

// The names are the linker script's and newlib's.
extern "C" {
extern std::uint32_t stack_top[];
extern std::uint8_t stack_guard[];
extern std::uint8_t bss_begin[];
extern std::uint8_t bss_end[];
extern char* __heap_limit;
void initialise_monitor_handles();
void __libc_init_array();
int program(int argc, char** argv) asm("main");  // C++ forbids a call of main by its name.
[[noreturn]] void reset();
[[noreturn]] void fault();
[[noreturn]] void report_fault(const std::uint32_t* frame);
}

namespace {

volatile std::uint32_t& register_at(std::uint32_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
}

constexpr std::uint32_t kCcr = 0xE000ED14;
constexpr std::uint32_t kCfsr = 0xE000ED28;
constexpr std::uint32_t kHfsr = 0xE000ED2C;
constexpr std::uint32_t kMmfar = 0xE000ED34;
constexpr std::uint32_t kCpacr = 0xE000ED88;
constexpr std::uint32_t kMpuCtrl = 0xE000ED94;
constexpr std::uint32_t kMpuRbar = 0xE000ED9C;
constexpr std::uint32_t kMpuRasr = 0xE000EDA0;

constexpr std::uint32_t kCcrDivideByZeroTrap = 1U << 4U;
constexpr std::uint32_t kCpacrFpu = 0xFU << 20U;
constexpr std::uint32_t kMpuEnableWithDefaultMap = (1U << 2U) | 1U;
constexpr std::uint32_t kRbarValid = 1U << 4U;
constexpr std::uint32_t kAccessNone = 0U << 24U;
constexpr std::uint32_t kAccessReadOnly = 6U << 24U;
constexpr std::uint32_t kGuardLen = 1024;
constexpr std::uint32_t kProgramLen = 4U << 20U;

void protect(std::uint32_t region, std::uint32_t base, std::uint32_t len, std::uint32_t access) {
    register_at(kMpuRbar) = base | kRbarValid | region;
    const auto size_field = static_cast<std::uint32_t>(std::countr_zero(len)) - 1;
    register_at(kMpuRasr) = access | (size_field << 1U) | 1U;
}

// Faults that a PC's operating system catches are caught here, too: null pointers, writes to constants, an
// overflowing stack, division by zero. A later region wins over an earlier one.
void set_traps() {
    protect(0, 0, kProgramLen, kAccessReadOnly);
    protect(1, 0, kGuardLen, kAccessNone);
    protect(2, reinterpret_cast<std::uint32_t>(stack_guard), kGuardLen, kAccessNone);
    register_at(kMpuCtrl) = kMpuEnableWithDefaultMap;
    register_at(kCcr) = register_at(kCcr) | kCcrDivideByZeroTrap;
}

// Cuts at blanks; there is no quoting.
int cut_into_arguments(char* text, std::array<char*, 16>& arguments) {
    std::size_t count = 0;
    char* rest = nullptr;
    for (char* word = strtok_r(text, " ", &rest); word != nullptr && count + 1 < arguments.size();
         word = strtok_r(nullptr, " ", &rest)) {
        arguments[count++] = word;
    }
    return static_cast<int>(count);
}

// Apart from reset(), so that none of this is compiled into it ahead of the FPU's enabling.
[[noreturn, gnu::noinline]] void run() {
    std::memset(bss_begin, 0, static_cast<std::size_t>(bss_end - bss_begin));
    __heap_limit = reinterpret_cast<char*>(stack_guard);
    set_traps();
    initialise_monitor_handles();
    __libc_init_array();
    std::array<char*, 16> arguments{};
    const int argument_count = cut_into_arguments(octoskin::target::command_line(), arguments);
    std::exit(program(argument_count, arguments.data()));
}

struct Vectors {
    std::uint32_t* initial_stack;
    void (*reset)();
    std::array<void (*)(), 14> exceptions;
};

}  // namespace

extern "C" {

// The processor reads these before any instruction runs. No interrupt is ever enabled, so the table ends with
// SysTick.
[[gnu::section(".vectors"), gnu::used]] const Vectors vectors{
    stack_top,
    reset,
    {fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault}};

void reset() {
    register_at(kCpacr) = kCpacrFpu;
    asm volatile("dsb\n isb" ::: "memory");
    run();
}

// The stack that overflowed is no place to push to; the guard is open to a handler, but the frame may be
// missing.
[[gnu::naked]] void fault() {
    asm volatile("mrs r0, msp\n ldr sp, =stack_top\n b report_fault");
}

void report_fault(const std::uint32_t* frame) {
    const std::uint32_t cfsr = register_at(kCfsr);
    constexpr std::uint32_t kFrameIsMissing = (1U << 4U) | (1U << 12U);  // MSTKERR, STKERR
    const std::uint32_t pc = (cfsr & kFrameIsMissing) != 0 ? 0 : frame[6];
    std::array<char, 128> text;
    std::snprintf(text.data(), text.size(),
                  "\nfault: pc 0x%08lx, HFSR 0x%08lx, CFSR 0x%08lx, MMFAR 0x%08lx\n",
                  static_cast<unsigned long>(pc), static_cast<unsigned long>(register_at(kHfsr)),
                  static_cast<unsigned long>(cfsr), static_cast<unsigned long>(register_at(kMmfar)));
    std::fflush(stdout);
    octoskin::target::write_raw(text.data());
    octoskin::target::end_machine(EXIT_FAILURE);
}

}  // extern "C"
