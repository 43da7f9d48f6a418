#include "firmware/port/stm32g4/fault_record.hpp"

#include <array>
#include <span>

#include "common/wire/crc.hpp"
#include "common/wire/names.hpp"

namespace octoskin::stm32g4 {

// The start value is not zero, so that cleared memory is no valid record.
std::uint32_t FaultRecord::checksum() const noexcept {
    constexpr std::uint32_t kMark = 0x0C70'5C1A;
    std::uint32_t crc = kMark;
    for (const std::uint32_t word : {kind_, where_, called_from_, status_, address_, uptime_us_}) {
        const std::array<std::uint8_t, 4> bytes = {
            static_cast<std::uint8_t>(word & 0xFFU), static_cast<std::uint8_t>((word >> 8U) & 0xFFU),
            static_cast<std::uint8_t>((word >> 16U) & 0xFFU), static_cast<std::uint8_t>(word >> 24U)};
        crc = crc32(bytes, crc);
    }
    return crc;
}

std::optional<Fault> FaultRecord::read() const noexcept {
    const auto kind = static_cast<wire::FaultKind>(kind_);
    if (crc_ != checksum() || !wire::is_known(kind)) return std::nullopt;
    return Fault{.kind = kind,
                 .where = where_,
                 .called_from = called_from_,
                 .status = status_,
                 .address = address_,
                 .uptime = {uptime_us_}};
}

void FaultRecord::write(const Fault& fault) noexcept {
    kind_ = static_cast<std::uint32_t>(fault.kind);
    where_ = fault.where;
    called_from_ = fault.called_from;
    status_ = fault.status;
    address_ = fault.address;
    uptime_us_ = fault.uptime.us;
    crc_ = checksum();
}

}  // namespace octoskin::stm32g4
