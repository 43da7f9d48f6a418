// Checks whether a program can be flashed to a board and will start there.
#pragma once

#include <string>
#include <vector>

#include "hw/image/elf_image.hpp"
#include "hw/rigfile/board_hardware.hpp"

namespace octoskin::image {

/// One message per fault, in the order of the checks; empty if the image passes:
/// - every segment lies within flash, before the configuration page, and overlaps no other;
/// - the vector table is complete and at the start of flash;
/// - the initial stack pointer is in RAM or at its end, and a multiple of 8; the reset vector is the entry;
/// - every vector except the reserved ones of the core and the chip is Thumb code within the image (ARMv7-M
///   ARM, "Vector table"; RM0440, "Nested vectored interrupt controller");
/// - it is compiled for ARMv7E-M with FPv4-D16 in single precision, arguments in floating-point registers;
/// - it reads the layout of configuration block that this program writes (common/config/image_identity.hpp).
[[nodiscard]] std::vector<std::string> faults_of(const ElfImage& image, const rig::BoardHardware& board);

}  // namespace octoskin::image
