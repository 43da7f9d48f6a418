#include "firmware/core/black_box.hpp"

#include <bit>

namespace octoskin::node {

static_assert((wire::kDumpHeaderBytes + kRecordedBytesMax + wire::kBlackBoxBytes - 1) /
                  wire::kBlackBoxBytes <=
              wire::kBlackBoxFramesMax);

BlackBox::BlackBox(BusRecorders& recorders, const Policy& policy) noexcept
    : recorders_(recorders), policy_(policy) {}

void BlackBox::on_fault(std::uint8_t bus, NodeTime now) noexcept {
    Pause& pause = fault_pauses_[bus];
    pause.update(now);
    if (!pause.is_over()) return;
    pause.begin(now, policy_.black_box_pause);
    on_request(bus, now);
}

void BlackBox::on_request(std::uint8_t bus, NodeTime now) noexcept {
    if (is_pending(bus) || !recorders_[bus]) return;
    if (pending_ == 0) current_ = bus;
    recorders_[bus]->freeze(now);
    pending_ = static_cast<std::uint8_t>(pending_ | (1U << bus));
}

void BlackBox::update(NodeTime now) noexcept {
    piece_pause_.update(now);
    for (Pause& pause : fault_pauses_) pause.update(now);
}

std::optional<wire::BlackBox> BlackBox::due() const noexcept {
    if (pending_ == 0 || !piece_pause_.is_over()) return std::nullopt;
    const BusRecorder& recorder = *recorders_[current_];
    wire::BlackBox piece{.bus = current_, .dump = dump_, .index = index_};
    const std::size_t first = std::size_t{index_} * wire::kBlackBoxBytes;
    for (std::size_t i = 0; i < piece.bytes.size() && first + i < recorder.dump_size(); ++i) {
        piece.bytes[i] = recorder.dump_byte(first + i);
    }
    return piece;
}

void BlackBox::sent(NodeTime now) noexcept {
    piece_pause_.begin(now, policy_.black_box_period);
    ++index_;
    BusRecorder& recorder = *recorders_[current_];
    if (std::size_t{index_} * wire::kBlackBoxBytes < recorder.dump_size()) return;
    recorder.thaw();
    pending_ = static_cast<std::uint8_t>(pending_ & ~(1U << current_));
    if (pending_ != 0) current_ = static_cast<std::uint8_t>(std::countr_zero(pending_));
    index_ = 0;
    dump_ = static_cast<std::uint8_t>((dump_ + 1U) % 4U);
}

std::optional<NodeTime> BlackBox::wake_time(NodeTime now) const noexcept {
    if (pending_ == 0) return std::nullopt;
    return piece_pause_.end().value_or(now);
}

}  // namespace octoskin::node
