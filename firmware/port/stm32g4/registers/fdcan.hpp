// The CAN controller. Offsets and bits: RM0440, as in ST's SVD file. From 0x80 on they differ from other
// controllers of the same family.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct FdcanMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"FDCAN1", 0x4000'6400}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"DBTP", 0x00C},  {"CCCR", 0x018},  {"NBTP", 0x01C},  {"PSR", 0x044},    {"TDCR", 0x048},
        {"IR", 0x050},    {"IE", 0x054},    {"ILS", 0x058},   {"ILE", 0x05C},    {"RXGFC", 0x080},
        {"RXF0S", 0x090}, {"RXF0A", 0x094}, {"TXBC", 0x0C0},  {"TXFQS", 0x0C4},  {"TXBRP", 0x0C8},
        {"TXBAR", 0x0CC}, {"TXBCR", 0x0D0}, {"TXBTO", 0x0D4}, {"TXBTIE", 0x0DC}, {"CKDIV", 0x100},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"DBTP.DSJW", 0, 4},   {"DBTP.DTSEG2", 4, 4}, {"DBTP.DTSEG1", 8, 5}, {"DBTP.DBRP", 16, 5},
        {"DBTP.TDC", 23},      {"CCCR.INIT", 0},      {"CCCR.CCE", 1},       {"CCCR.ASM", 2},
        {"CCCR.MON", 5},       {"CCCR.FDOE", 8},      {"CCCR.BRSE", 9},      {"NBTP.NTSEG2", 0, 7},
        {"NBTP.NTSEG1", 8, 8}, {"NBTP.NBRP", 16, 9},  {"NBTP.NSJW", 25, 7},  {"PSR.EP", 5},
        {"PSR.BO", 7},         {"TDCR.TDCO", 8, 7},   {"IR.RF0L", 2},        {"IR.MRAF", 14},
        {"IR.PEA", 21},        {"IR.PED", 22},        {"IE.RF0NE", 0},       {"IE.RF0LE", 2},
        {"IE.TCE", 7},         {"IE.MRAFE", 14},      {"IE.EPE", 17},        {"IE.BOE", 19},
        {"IE.PEAE", 21},       {"IE.PEDE", 22},       {"ILE.EINT0", 0},      {"RXGFC.RRFE", 0},
        {"RXGFC.ANFE", 2, 2},  {"RXGFC.ANFS", 4, 2},  {"RXGFC.LSS", 16, 5},  {"RXF0S.F0FL", 0, 4},
        {"RXF0S.F0GI", 8, 2},  {"RXF0A.F0AI", 0, 3},  {"TXBC.TFQM", 24},     {"TXFQS.TFQPI", 16, 2},
        {"TXFQS.TFQF", 21},    {"TXBRP.TRP", 0, 3},   {"TXBAR.AR", 0, 3},    {"TXBCR.CR", 0, 3},
        {"TXBTO.TO", 0, 3},    {"TXBTIE.TIE", 0, 3},  {"CKDIV.PDIV", 0, 4},
    });
};
inline constexpr Peripheral<FdcanMap> fdcan1{"FDCAN1"};

/// The SVD file lists this address as a template called FDCAN; it is the message RAM of all three
/// controllers.
inline constexpr Address kMessageRamBase = 0x4000'A400;

}  // namespace octoskin::stm32g4
