// Logged transfers of ST's driver: ULD 3.5.2, compiled and run against registers of fixed values. The bytes
// written are ST's; the values read are those fixed ones.
#pragma once

namespace octoskin::vl53l1x::st {

inline constexpr const char* kBootState = "R 00E5 1 -> 03";
inline constexpr const char* kGetSensorId = "R 010F 2 -> EA CC";
inline constexpr const char* kSensorInit = R"(
    W 002D 00 | W 002E 00 | W 002F 00 | W 0030 01 | W 0031 02 | W 0032 00
    W 0033 02 | W 0034 08 | W 0035 00 | W 0036 08 | W 0037 10 | W 0038 01
    W 0039 01 | W 003A 00 | W 003B 00 | W 003C 00 | W 003D 00 | W 003E FF
    W 003F 00 | W 0040 0F | W 0041 00 | W 0042 00 | W 0043 00 | W 0044 00
    W 0045 00 | W 0046 20 | W 0047 0B | W 0048 00 | W 0049 00 | W 004A 02
    W 004B 0A | W 004C 21 | W 004D 00 | W 004E 00 | W 004F 05 | W 0050 00
    W 0051 00 | W 0052 00 | W 0053 00 | W 0054 C8 | W 0055 00 | W 0056 00
    W 0057 38 | W 0058 FF | W 0059 01 | W 005A 00 | W 005B 08 | W 005C 00
    W 005D 00 | W 005E 01 | W 005F CC | W 0060 0F | W 0061 01 | W 0062 F1
    W 0063 0D | W 0064 01 | W 0065 68 | W 0066 00 | W 0067 80 | W 0068 08
    W 0069 B8 | W 006A 00 | W 006B 00 | W 006C 00 | W 006D 00 | W 006E 0F
    W 006F 89 | W 0070 00 | W 0071 00 | W 0072 00 | W 0073 00 | W 0074 00
    W 0075 00 | W 0076 00 | W 0077 01 | W 0078 0F | W 0079 0D | W 007A 0E
    W 007B 0E | W 007C 00 | W 007D 00 | W 007E 02 | W 007F C7 | W 0080 FF
    W 0081 9B | W 0082 00 | W 0083 00 | W 0084 00 | W 0085 01 | W 0086 00
    W 0087 00
    W 0087 40
    R 0030 1 -> 01 | R 0031 1 -> 02
    R 0030 1 -> 01 | R 0031 1 -> 03
    W 0086 01 | W 0087 00
    W 0008 09 | W 000B 00)";

/// 100 ms are in force.
inline constexpr const char* kSetDistanceModeLong = R"(
    R 005E 2 -> 01 CC
    W 004B 0A | W 0060 0F | W 0063 0D | W 0069 B8 | W 0078 0F 0D | W 007A 0E 0E
    R 004B 1 -> 0A | W 005E 01 CC | W 0061 01 EA)";
/// 33 ms are in force.
inline constexpr const char* kSetDistanceModeShort = R"(
    R 005E 2 -> 00 60
    W 004B 14 | W 0060 07 | W 0063 05 | W 0069 38 | W 0078 07 05 | W 007A 06 06
    R 004B 1 -> 14 | W 005E 00 D6 | W 0061 00 6E)";

inline constexpr const char* kSetTimingBudget33Long = "R 004B 1 -> 0A | W 005E 00 60 | W 0061 00 6E";
inline constexpr const char* kSetTimingBudget20Short = "R 004B 1 -> 14 | W 005E 00 51 | W 0061 00 6E";
inline constexpr const char* kSetInterMeasurement50 = "R 00DE 2 -> 00 25 | W 006C 00 00 07 C4";
inline constexpr const char* kGetInterMeasurement = "R 006C 4 -> 00 00 07 C4 | R 00DE 2 -> 00 25";

inline constexpr const char* kStartRanging = "W 0087 40";
inline constexpr const char* kNotReady = "R 0030 1 -> 01 | R 0031 1 -> 02";
inline constexpr const char* kReady = "R 0030 1 -> 01 | R 0031 1 -> 03";
inline constexpr const char* kGetResult = "R 0089 17 -> 09 00 05 1A 00 08 00 00 10 00 10 50 00 04 D2 07 80";
inline constexpr const char* kClearInterrupt = "W 0086 01";
inline constexpr const char* kStopRanging = "W 0087 00";

inline constexpr const char* kSetRoi8x8 = "R 013E 1 -> C7 | W 007F C7 | W 0080 77";
inline constexpr const char* kSetRoiCentre167 = "W 007F A7";
inline constexpr const char* kSetDistanceThreshold100To300Inside =
    "R 0046 1 -> 20 | W 0046 03 | W 0072 01 2C | W 0074 00 64";
inline constexpr const char* kSetOffsetMinus13 = "W 001E FF CC | W 0020 00 00 | W 0022 00 00";
inline constexpr const char* kSetXtalk2000 = "W 0018 00 00 | W 001A 00 00 | W 0016 04 00";
inline constexpr const char* kSetSignalThreshold1024 = "W 0066 00 80";
inline constexpr const char* kSetSigmaThreshold15 = "W 0064 00 3C";
inline constexpr const char* kSetInterruptPolarityLow = "R 0030 1 -> 01 | W 0030 11";
inline constexpr const char* kSetI2cAddress54 = "W 0001 2A";
inline constexpr const char* kStartTemperatureUpdate = R"(
    W 0008 81 | W 000B 92 | W 0087 40
    R 0030 1 -> 01 | R 0031 1 -> 02
    R 0030 1 -> 01 | R 0031 1 -> 03
    W 0086 01 | W 0087 00 | W 0008 09 | W 000B 00)";

}  // namespace octoskin::vl53l1x::st
