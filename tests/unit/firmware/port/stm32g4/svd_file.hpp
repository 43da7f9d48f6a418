// What ST's SVD file says about registers: the part that the port's tables are checked against.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace octoskin::test {

struct SvdField {
    unsigned lsb = 0;
    unsigned width = 0;
};
struct SvdRegister {
    unsigned offset = 0;
    std::map<std::string, SvdField> fields;
};
struct SvdPeripheral {
    std::uint32_t base = 0;
    std::map<std::string, SvdRegister> registers;  ///< without the peripheral's name in front
};
struct SvdFile {
    std::map<std::string, SvdPeripheral> peripherals;
    std::map<std::string, unsigned> interrupts;
};

/// Throws std::runtime_error if the file cannot be read or has no peripherals.
[[nodiscard]] SvdFile read_svd(const std::string& path);

}  // namespace octoskin::test
