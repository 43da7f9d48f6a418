#include "host/core/black_box/transfer_script.hpp"

#include <fmt/format.h>

#include <optional>
#include <span>

#include "common/wire/black_box.hpp"

namespace octoskin {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kIndexBytes = 2;

/// States what is missing of an incomplete dump.
std::string rest_of(const Dump& dump) {
    const auto pieces = dump.pieces();
    return fmt::format("the rest never came: {} of {} pieces did, of 20 a second; keep candump running",
                       dump.pieces_came(), pieces ? std::to_string(*pieces) : "an unknown number of");
}

std::string hex(Bytes bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) {
        text += fmt::format(" {:02X}", byte);
    }
    return text;
}

/// The script language has writes of an index with data, and reads at an index. Our driver does nothing else.
std::string line_of(const wire::RecordedTransfer& transfer) {
    const wire::TransferHeader& header = transfer.header;
    const bool is_read = header.read_asked > 0;
    const bool is_expressible = is_read ? header.written == kIndexBytes : header.written > kIndexBytes;
    if (!is_expressible) {
        return fmt::format("# not of our driver: wrote{}, read {} bytes", hex(transfer.written),
                           header.read_asked);
    }
    const Bytes index = transfer.written.first(kIndexBytes);
    std::string line = fmt::format("{} {:02X}{:02X}", is_read ? "R" : "W", index[0], index[1]);
    line += is_read ? fmt::format(" {}", header.read_asked) : hex(transfer.written.subspan(kIndexBytes));
    if (header.outcome != wire::TransferOutcome::done) {
        return line + fmt::format(" ! {}", wire::name(header.outcome));
    }
    return is_read ? line + " ->" + hex(transfer.read) : line;
}

class Writer {
  public:
    void add(const wire::RecordedTransfer& transfer) {
        const wire::TransferHeader& header = transfer.header;
        if (header.address != address_) {
            text_ += fmt::format("ADDRESS {:02X}\n", header.address);
            address_ = header.address;
        }
        const std::string line = line_of(transfer);
        const auto since = last_start_ ? elapsed(*last_start_, header.start) : Microseconds{0};
        text_ += fmt::format("{}  # {} us, +{}\n", line, header.start.us, since.count());
        last_start_ = header.start;
    }
    void comment(const std::string& text) { text_ += "# " + text + "\n"; }
    [[nodiscard]] std::string take() { return std::move(text_); }

  private:
    std::string text_;
    std::optional<std::uint8_t> address_;
    std::optional<NodeTime> last_start_;
};

}  // namespace

std::string transfer_script(const Dump& dump) {
    Writer writer;
    const auto header = wire::decode_dump_header(dump.bytes);
    if (!header) {
        writer.comment(fmt::format("node {}, I2C bus {}: {}", dump.node, dump.bus, rest_of(dump)));
        return writer.take();
    }
    writer.comment(fmt::format("node {}, I2C bus {}, dump {}: recorded until {} us", dump.node, dump.bus,
                               dump.number, header->frozen.us));
    Bytes rest = Bytes(dump.bytes).subspan(wire::kDumpHeaderBytes);
    while (!rest.empty()) {
        const auto transfer = wire::take_transfer(rest);
        if (!transfer) {
            const bool is_cut = transfer.error() == wire::DumpError::truncated && !dump.is_complete;
            writer.comment(is_cut ? rest_of(dump) : "the rest is damaged");
            return writer.take();
        }
        writer.add(*transfer);
    }
    if (!dump.is_complete) {
        writer.comment(rest_of(dump));
    }
    return writer.take();
}

}  // namespace octoskin
