#include "host/core/ingest/register_reports.hpp"

#include <gmock/gmock.h>

namespace octoskin {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using wire::FaultKind;
using wire::RegisterReport;

wire::InfoFault fault(FaultKind kind, std::uint8_t subject, std::uint8_t read, std::uint8_t index = 0x47) {
    const RegisterReport report{.subject = subject, .index = index, .written = 0x0B, .read = read};
    return {.kind = kind, .where = report.where()};
}

TEST(RegisterReport, survives_its_four_bytes) {
    const RegisterReport report{.subject = 0x21, .index = 0x47, .written = 0x0B, .read = 0x0C};
    EXPECT_EQ(report.where(), 0x2147'0B0CU);
    EXPECT_EQ(RegisterReport::of(0x2147'0B0CU), report);
}

TEST(RegisterReports, hold_the_newest_of_each_sensor) {
    RegisterReports reports;
    reports.take(fault(FaultKind::register_fixed, 3, 0x0C));
    reports.take(fault(FaultKind::register_fixed, 5, 0x0C));
    reports.take(fault(FaultKind::register_fixed, 3, 0x0E));
    ASSERT_TRUE(reports.of_sensor(3));
    EXPECT_EQ(reports.of_sensor(3)->read, 0x0E);
    EXPECT_EQ(reports.of_sensor(5)->read, 0x0C);
    EXPECT_FALSE(reports.of_sensor(4));
    EXPECT_TRUE(reports.alike().empty());
}

TEST(RegisterReports, hold_what_is_alike_once_and_no_longer_against_the_sensors_that_showed_it) {
    RegisterReports reports;
    reports.take(fault(FaultKind::register_fixed, 3, 0x0C));
    reports.take(fault(FaultKind::register_fixed, 5, 0x0E));
    for (int i = 0; i < 3; ++i) reports.take(fault(FaultKind::register_alike, 3, 0x0C));
    reports.take(fault(FaultKind::register_alike, 4, 0x01, 0x7C));
    EXPECT_EQ(reports.alike().size(), 2U);
    EXPECT_FALSE(reports.of_sensor(3));
    EXPECT_TRUE(reports.of_sensor(5)) << "another value";
}

TEST(RegisterReports, take_no_other_fault_no_sensor_that_cannot_be_and_not_more_than_a_node_learns) {
    RegisterReports reports;
    for (const auto kind : {FaultKind::watchdog, FaultKind::xshut_stuck, FaultKind::boot_late})
        reports.take(fault(kind, 3, 0x0C));
    EXPECT_FALSE(reports.of_sensor(3));
    for (const std::uint8_t subject : std::to_array<std::uint8_t>({63, 64, 255}))
        reports.take(fault(FaultKind::register_fixed, subject, 0x0C));
    for (unsigned read = 0; read < 256; ++read)
        reports.take(fault(FaultKind::register_alike, 3, static_cast<std::uint8_t>(read)));
    EXPECT_EQ(reports.alike().size(), 32U);
}

TEST(RegisterReports, name_register_written_and_read_value_and_the_key_that_leaves_it_out) {
    const RegisterReport report{.subject = 3, .index = 0x47, .written = 0x0B, .read = 0x0C};
    EXPECT_THAT(text_of(report), AllOf(HasSubstr("0x47"), HasSubstr("0x0B"), HasSubstr("0x0C")));
    EXPECT_THAT(leave_out_text(report, "ring"),
                AllOf(HasSubstr("verification: {leave_out: [0x47]}"), HasSubstr("'ring'")));
}

}  // namespace
}  // namespace octoskin
