// Every register, bit field and interrupt number that the port can name, against ST's own SVD file. README.md
// of firmware/port/stm32g4 says where to get it; without it these tests are skipped.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>

#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"
#include "firmware/port/stm32g4/registers/core.hpp"
#include "firmware/port/stm32g4/registers/external_interrupts.hpp"
#include "firmware/port/stm32g4/registers/fdcan.hpp"
#include "firmware/port/stm32g4/registers/gpio.hpp"
#include "firmware/port/stm32g4/registers/i2c.hpp"
#include "firmware/port/stm32g4/registers/interrupts.hpp"
#include "firmware/port/stm32g4/registers/lpuart.hpp"
#include "firmware/port/stm32g4/registers/timer.hpp"
#include "tests/unit/firmware/port/stm32g4/svd_file.hpp"

namespace octoskin::stm32g4 {
namespace {

std::string svd_path() {
    const char* path = std::getenv("OCTOSKIN_SVD");
    return path != nullptr ? path : OCTOSKIN_SVD;
}

/// Read once: three megabytes of XML.
const test::SvdFile& svd() {
    static const test::SvdFile file = test::read_svd(svd_path());
    return file;
}

/// "ISER#" and 2 make "ISER2".
std::string numbered(std::string_view name, unsigned number) {
    std::string result(name);
    const auto place = result.find('#');
    if (place != std::string::npos) result.replace(place, 1, std::to_string(number));
    return result;
}

/// The SVD names no fields for these; ARMv7-M B3.4.9 gives every IPR the same four.
const std::set<std::string> kRegistersWithoutFields = {"IPR21", "IPR22", "IPR23", "IPR24", "IPR25"};

void check_field(const test::SvdRegister& in, const std::string& name, unsigned lsb, unsigned width) {
    const auto found = in.fields.find(name);
    ASSERT_NE(found, in.fields.end()) << name;
    EXPECT_EQ(found->second.lsb, lsb) << name;
    EXPECT_EQ(found->second.width, width) << name;
}

const RegisterEntry* entry_of(const auto& entries, std::string_view name) {
    for (const RegisterEntry& entry : entries) {
        if (entry.name == name) return &entry;
    }
    return nullptr;
}

template <class Map>
class RegisterMapTest : public ::testing::Test {
  protected:
    void SetUp() override {
        if (svd_path().empty()) GTEST_SKIP() << "OCTOSKIN_SVD is not set";
    }
    static void check_registers(const test::SvdPeripheral& expected) {
        for (const RegisterEntry& entry : Map::kRegisters) {
            for (unsigned n = 0; n < entry.count; ++n) {
                const std::string name = numbered(entry.name, n);
                const auto found = expected.registers.find(name);
                ASSERT_NE(found, expected.registers.end()) << name;
                EXPECT_EQ(found->second.offset, entry.offset + 4 * n) << name;
            }
        }
    }
    static void check_fields(const test::SvdPeripheral& expected) {
        for (const FieldEntry& field : Map::kFields) {
            const std::string_view register_name = field.name.substr(0, field.name.find('.'));
            const std::string_view field_name = field.name.substr(field.name.find('.') + 1);
            const RegisterEntry* in = entry_of(Map::kRegisters, register_name);
            ASSERT_NE(in, nullptr) << field.name;
            for (unsigned r = 0; r < in->count; ++r) {
                const std::string where = numbered(register_name, r);
                if (kRegistersWithoutFields.contains(where)) continue;
                SCOPED_TRACE(where);
                for (unsigned n = 0; n < field.count; ++n) {
                    check_field(expected.registers.at(where), numbered(field_name, field.first + n),
                                field.lsb + n * field.width, field.width);
                }
            }
        }
    }
};

using Maps = ::testing::Types<RccMap, PwrMap, FlashMap, GpioMap, TimerMap, IwdgMap, LpuartMap, I2cMap,
                              FdcanMap, NvicMap, SyscfgMap, ExtiMap, ScbMap, FpuMap, CpacrMap>;
TYPED_TEST_SUITE(RegisterMapTest, Maps);

TYPED_TEST(RegisterMapTest, agrees_with_st) {
    for (const Instance& instance : TypeParam::kInstances) {
        const std::string name(instance.name);
        SCOPED_TRACE(name);
        ASSERT_TRUE(svd().peripherals.contains(name));
        const test::SvdPeripheral& expected = svd().peripherals.at(name);
        EXPECT_EQ(expected.base, instance.base);
        TestFixture::check_registers(expected);
        TestFixture::check_fields(expected);
    }
}

TEST(Interrupts, have_the_numbers_of_st) {
    if (svd_path().empty()) GTEST_SKIP() << "OCTOSKIN_SVD is not set";
    for (const InterruptEntry& entry : kInterruptNames) {
        const std::string name(entry.name);
        ASSERT_TRUE(svd().interrupts.contains(name)) << name;
        EXPECT_EQ(svd().interrupts.at(name), static_cast<unsigned>(entry.number)) << name;
    }
    for (const auto& [name, number] : svd().interrupts) EXPECT_LT(number, kInterruptCount) << name;
}

TEST(MessageRam, is_where_the_template_of_the_can_controllers_is) {
    if (svd_path().empty()) GTEST_SKIP() << "OCTOSKIN_SVD is not set";
    EXPECT_EQ(svd().peripherals.at("FDCAN").base, kMessageRamBase);
}

}  // namespace
}  // namespace octoskin::stm32g4
