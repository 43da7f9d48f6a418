#include "hw/sim/board_link/message.hpp"

#include <cstring>
#include <type_traits>

namespace octoskin::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

class Writer {
  public:
    explicit Writer(Bytes& bytes) : bytes_(bytes) {}
    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        append(&value, sizeof value);
    }
    void put(const std::string& text) {
        put(static_cast<std::uint32_t>(text.size()));
        append(text.data(), text.size());
    }

  private:
    void append(const void* from, std::size_t size) {
        if (size == 0) return;
        const std::size_t at = bytes_.size();
        bytes_.resize(at + size);
        std::memcpy(bytes_.data() + at, from, size);
    }
    Bytes& bytes_;
};

class Reader {
  public:
    explicit Reader(const Bytes& bytes) : bytes_(bytes) {}
    template <class T>
    T get() {
        static_assert(std::is_trivially_copyable_v<T>);
        need(sizeof(T));
        T value;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    std::string get_text() {
        const auto size = get<std::uint32_t>();
        need(size);
        const std::string text(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                               bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
        at_ += size;
        return text;
    }
    void end() const {
        if (at_ != bytes_.size()) throw BoardLinkError("board link: a message is too long");
    }

  private:
    void need(std::size_t size) const {
        if (bytes_.size() - at_ < size) throw BoardLinkError("board link: a message is too short");
    }
    const Bytes& bytes_;
    std::size_t at_ = 0;
};

/// Trivially copyable, which std::optional<double> is not guaranteed to be.
struct FlatReturn {
    bool has_range;
    double range_m, sigma_m, peak_signal_mcps, ambient_mcps;
};

void write(Writer& writer, const RunUntil& message) {
    writer.put(message.time);
    writer.put(static_cast<std::uint32_t>(message.events.size()));
    for (const BusEvent& event : message.events) writer.put(event);
}
void write(Writer& writer, const HasRun& message) {
    writer.put(message.offer.has_value());
    if (message.offer) writer.put(*message.offer);
}
void write(Writer& writer, const WhatIsSeen& message) {
    writer.put(message);
}
void write(Writer& writer, const Seen& message) {
    const RangingReturn& what = message.what;
    writer.put(FlatReturn{what.range_m.has_value(), what.range_m.value_or(0.0), what.sigma_m,
                          what.peak_signal_mcps, what.ambient_mcps});
}
void write(Writer&, const AskSummary&) {}
void write(Writer& writer, const BoardSummary& message) {
    writer.put(message.instructions);
    writer.put(message.violations);
    writer.put(message.i2c_busy_s);
    writer.put(message.longest_awake_us);
    writer.put(message.counter_zero);
    writer.put(message.first_address);
    writer.put(message.report);
}

RunUntil read_run_until(Reader& reader) {
    RunUntil message{.time = reader.get<SimTime>(), .events = {}};
    const auto count = reader.get<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) message.events.push_back(reader.get<BusEvent>());
    return message;
}
HasRun read_has_run(Reader& reader) {
    HasRun message;
    if (reader.get<bool>()) message.offer = reader.get<wire::CanFrame>();
    return message;
}
Seen read_seen(Reader& reader) {
    const auto flat = reader.get<FlatReturn>();
    RangingReturn what{.range_m = {},
                       .sigma_m = flat.sigma_m,
                       .peak_signal_mcps = flat.peak_signal_mcps,
                       .ambient_mcps = flat.ambient_mcps};
    if (flat.has_range) what.range_m = flat.range_m;
    return {what};
}
BoardSummary read_summary(Reader& reader) {
    BoardSummary message;
    message.instructions = reader.get<std::uint64_t>();
    message.violations = reader.get<std::uint64_t>();
    message.i2c_busy_s = reader.get<std::array<double, 4>>();
    message.longest_awake_us = reader.get<double>();
    message.counter_zero = reader.get<SimTime>();
    message.first_address = reader.get<SimTime>();
    message.report = reader.get_text();
    return message;
}

BoardMessage read(Reader& reader, std::uint8_t kind) {
    switch (kind) {
        case 0:
            return read_run_until(reader);
        case 1:
            return read_has_run(reader);
        case 2:
            return reader.get<WhatIsSeen>();
        case 3:
            return read_seen(reader);
        case 4:
            return AskSummary{};
        case 5:
            return read_summary(reader);
        default:
            throw BoardLinkError("board link: a message of an unknown kind");
    }
}

}  // namespace

std::vector<std::uint8_t> encode_message(const BoardMessage& message) {
    Bytes bytes;
    Writer writer(bytes);
    writer.put(static_cast<std::uint8_t>(message.index()));
    std::visit([&writer](const auto& kind) { write(writer, kind); }, message);
    return bytes;
}

BoardMessage decode_message(const std::vector<std::uint8_t>& bytes) {
    Reader reader(bytes);
    const auto kind = reader.get<std::uint8_t>();
    BoardMessage message = read(reader, kind);
    reader.end();
    return message;
}

}  // namespace octoskin::sim
