#pragma once

// Requests of a program to its debugger or emulator. Source: ARM "Semihosting for AArch32 and AArch64" 2.0.
// Newlib's rdimon library does files and output; these functions are missing there.
namespace octoskin::target {

// Ends the emulator with this exit code (SYS_EXIT_EXTENDED).
[[noreturn]] void end_machine(int exit_code);

// Writes at once, without newlib's buffers and heap: usable from a fault handler (SYS_WRITE0).
void write_raw(const char* text);

// The command line as the emulator was given it, program first; empty if it is longer than 1 KiB
// (SYS_GET_CMDLINE). The text lives as long as the program and may be cut into arguments in place.
char* command_line();

}  // namespace octoskin::target
