// The bytes of one frame of each layout, as any third-party node must send them. Computed by hand with a few
// lines of Python (fields joined as one little-endian integer, binascii.crc_hqx, a bitwise CRC-8), not with
// the codec. The messages are those of tests/support/wire/message_cases.cpp. If this test fails, the protocol
// has changed: give it a new version.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

#include "common/wire/codec.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::test {
namespace {

struct Golden {
    const char* name;
    const char* frame;  ///< identifier#payload, hexadecimal
};

constexpr std::array<Golden, 25> kGolden = {{
    {"RANGE", "202#092B49934AADAA17"},
    {"RANGE_AUX", "302#095500040800AE23"},
    {"HEARTBEAT", "17E#998AEFBE3412B840"},
    {"SENSOR_HEALTH", "281#8168409C094DBF97"},
    {"RANGE_FD of 1", "241#0950245E9A200AE0FF2002C08A460200000055AE"},
    {"RANGE_FD of 2", "241#1150245E9A200AE0FF2002C08A46028FA45E17410A00002102E0A75602006516"},
    {"RANGE_FD of 3",
     "241#1950245E9A200AE0FF2002C08A46028FA45E17410A00002102E0A75602CE245F94610A2000210200C5660200"
     "00000C9B"},
    {"RANGE_FD of 4",
     "241#2150245E9A200AE0FF2002C08A46028FA45E17410A00002102E0A75602CE245F94610A2000210200C566020D"
     "A55F11820A4000210220E2760200000000002152"},
    {"NODE_INFO uid_low", "2C7#010102030405FAAB"},
    {"NODE_INFO uid_high", "2C7#090708090A0BFB37"},
    {"NODE_INFO identity", "2C7#11EFBEADDE1103D0"},
    {"NODE_INFO build", "2C7#190DF0FECA31D42F"},
    {"NODE_INFO counters", "2C7#212D012E012F01F2"},
    {"NODE_INFO traffic", "2C7#29910192012B2CB6"},
    {"NODE_INFO fault", "2C7#3162341200084DC8"},
    {"SYNC", "040#A99BCC"},
    {"FOLLOW_UP", "080#A9CB04FB711F01E0"},
    {"SYNC_REPORT", "1C3#A998BADCFE24DB"},
    {"JOINT_STATE pair", "183#A91E0CDCEBE5311E"},
    {"JOINT_STATE last", "183#B90A04F4EFCDABF7"},
    {"MARK", "100#09CB04FB711F0173"},
    {"COMMAND", "0FF#193E2100817FFA"},
    {"REFLEX", "002#094B9AD4AA0ABC52"},
    {"BLACK_BOX", "7C2#3196010203040586"},
    {"CALIBRATION", "342#091B812EFB21843C"},
}};

std::string text_of(const wire::CanFrame& frame) {
    std::array<char, 8> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%03X#", static_cast<unsigned>(frame.can_id));
    std::string text = buffer.data();
    for (const std::uint8_t byte : frame.payload()) {
        std::snprintf(buffer.data(), buffer.size(), "%02X", byte);
        text += buffer.data();
    }
    return text;
}

TEST(CodecGolden, every_layout_has_the_bytes_of_protocol_version_1) {
    const auto cases = all_message_cases();
    ASSERT_EQ(cases.size(), kGolden.size());
    for (std::size_t i = 0; i < cases.size(); ++i) {
        EXPECT_EQ(cases[i].name, kGolden.at(i).name);
        EXPECT_EQ(text_of(encode(cases[i].message, cases[i].node_id)), kGolden.at(i).frame) << cases[i].name;
    }
}

}  // namespace
}  // namespace octoskin::test
