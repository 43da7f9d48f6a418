#include "hw/sim/can/simulated_can_bus.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/core/transmit_places.hpp"

namespace octoskin::sim {

namespace {

constexpr std::uint32_t kErrorsPerFrame = 8;
constexpr std::uint32_t kErrorsUntilPassive = 128;
constexpr std::uint32_t kErrorsUntilBusOff = 256;
constexpr std::int64_t kRecoveryBits = 128 * 11;

void flip_bit(wire::CanFrame& frame, std::uint16_t bit) {
    if (frame.payload_len == 0) return;
    const std::size_t index = bit % (8U * frame.payload_len);
    frame.data[index / 8] = static_cast<std::uint8_t>(frame.data[index / 8] ^ (1U << (index % 8)));
}

SimTime later(SimTime time, std::int64_t by_us) {
    return {time.us + by_us};
}

}  // namespace

std::int64_t frame_duration_us(const wire::CanFrame& frame, const wire::BitRates& rates) {
    return static_cast<std::int64_t>(std::ceil(wire::worst_case_seconds(frame, rates) * 1e6 - 1e-9));
}

SimulatedCanBus::SimulatedCanBus(const wire::BitRates& rates) : rates_(rates) {}

node::CanTransmitter& SimulatedCanBus::attach(FrameHandler on_frame, std::size_t mailboxes) {
    return controllers_.emplace_back(*this, std::move(on_frame), mailboxes);
}

node::CanTransmitter& SimulatedCanBus::attach_node(FrameHandler on_frame) {
    Controller& controller = controllers_.emplace_back(*this, std::move(on_frame), node::kTransmitPlaces);
    controller.is_node = true;
    return controller;
}

CanSeat& SimulatedCanBus::attach_seat(CanSeatHandlers handlers) {
    Controller& controller = controllers_.emplace_back(*this, handlers.on_frame, 1);
    controller.seat = std::move(handlers);
    return controller;
}

void SimulatedCanBus::Controller::offer(const std::optional<wire::CanFrame>& frame) {
    pending.clear();
    if (frame) pending.push_back({.frame = *frame, .given = bus_.now_});
}

const wire::CanFrame* SimulatedCanBus::Controller::under_way() const {
    const bool is_sending = bus_.under_way_ && bus_.under_way_->sender == this;
    return is_sending ? &bus_.under_way_->frame : nullptr;
}

void SimulatedCanBus::tap(FrameHandler on_frame) {
    taps_.push_back(std::move(on_frame));
}

void SimulatedCanBus::add_fault(const CanFault& fault) {
    faults_.push_back({.fault = fault});
}

bool SimulatedCanBus::Controller::send(const wire::CanFrame& frame) {
    if (!has_room_for(frame) || !is_on_bus(bus_.now_)) return false;
    pending.push_back({.frame = frame, .given = bus_.now_});
    return true;
}

/// In a node's controller a frame occupies its buffer until it has ended.
bool SimulatedCanBus::Controller::has_room_for(const wire::CanFrame& frame) const {
    if (!is_node) return pending.size() < mailbox_count_;
    std::vector<std::uint32_t> waiting;
    for (const Pending& other : pending) waiting.push_back(other.frame.can_id);
    if (const wire::CanFrame* sending = under_way()) waiting.push_back(sending->can_id);
    return node::may_join(waiting, frame.can_id);
}

bool SimulatedCanBus::Controller::is_on_bus(SimTime time) const {
    return !is_off_ || (back_at_ && *back_at_ <= time);
}

node::CanState SimulatedCanBus::Controller::state() const {
    if (is_off_) return is_on_bus(bus_.now_) ? node::CanState::active : node::CanState::bus_off;
    return transmit_errors_ >= kErrorsUntilPassive ? node::CanState::passive : node::CanState::active;
}

void SimulatedCanBus::Controller::discard() {
    for (const Pending& frame : pending) given_up_.push_back(frame.frame);
    pending.clear();
}

std::optional<wire::CanFrame> SimulatedCanBus::Controller::take_given_up() {
    if (given_up_.empty()) return std::nullopt;
    const wire::CanFrame oldest = given_up_.front();
    given_up_.pop_front();
    return oldest;
}

void SimulatedCanBus::Controller::restart() {
    if (!is_off_ || back_at_) return;
    const std::int64_t way_back_us =
        (kRecoveryBits * 1'000'000 + bus_.rates_.nominal - 1) / bus_.rates_.nominal;
    back_at_ = later(bus_.now_, way_back_us);
}

void SimulatedCanBus::Controller::on_sent(const wire::CanFrame& frame, SimTime end) {
    if (seat) {
        if (seat->on_sent) seat->on_sent(frame, end);
        return;
    }
    settle();
    if (transmit_errors_ > 0) --transmit_errors_;
}

void SimulatedCanBus::Controller::settle() {
    if (!is_off_ || !is_on_bus(bus_.now_)) return;
    is_off_ = false;
    transmit_errors_ = 0;
    back_at_.reset();
}

void SimulatedCanBus::Controller::on_error(const Pending& disturbed) {
    if (seat) {
        if (seat->on_disturbed) seat->on_disturbed(disturbed.frame, disturbed.given);
        return;
    }
    settle();
    transmit_errors_ += kErrorsPerFrame;
    is_off_ = transmit_errors_ >= kErrorsUntilBusOff;
    pending.insert(pending.begin(), disturbed);
}

void SimulatedCanBus::advance(SimTime now) {
    // Each turn ends one frame, delivers one batch or starts one frame, all of them bounded by what is
    // pending.
    while (true) {
        const bool is_ending = under_way_ && under_way_->end <= now;
        const bool is_delivery_due = !heard_.empty() && heard_.begin()->first <= now;
        if (is_delivery_due && !(is_ending && under_way_->end < heard_.begin()->first)) {
            deliver_due(heard_.begin()->first);
        } else if (is_ending) {
            end_transmission();
        } else if (under_way_ || !start_transmission(now)) {
            break;
        }
    }
    now_ = std::max(now_, now);
}

void SimulatedCanBus::end_transmission() {
    const Transmission ended = *std::exchange(under_way_, std::nullopt);
    now_ = ended.end;
    idle_since_ = ended.end;
    if (take_disturbance(ended.frame)) {
        ended.sender->on_error({.frame = ended.frame, .given = ended.end});
        return;
    }
    ended.sender->on_sent(ended.frame, ended.end);
    schedule_heard(ended);
}

bool SimulatedCanBus::take_disturbance(const wire::CanFrame& frame) {
    bool is_disturbed = false;
    for (ActiveFault& active : faults_) {
        if (active.fault.kind != CanFaultKind::disturb) continue;
        if (active.fault.can_id && *active.fault.can_id != frame.can_id) continue;
        is_disturbed = active.fault.hits(active.matches++) || is_disturbed;
    }
    return is_disturbed;
}

void SimulatedCanBus::schedule_heard(const Transmission& ended) {
    Transmission heard = ended;
    int times = 1;
    for (ActiveFault& active : faults_) {
        if (active.fault.kind == CanFaultKind::disturb) continue;
        if (active.fault.can_id && *active.fault.can_id != ended.frame.can_id) continue;
        if (!active.fault.hits(active.matches++)) continue;
        switch (active.fault.kind) {
            case CanFaultKind::disturb:
                break;
            case CanFaultKind::drop:
                times = 0;
                break;
            case CanFaultKind::duplicate:
                times *= 2;
                break;
            case CanFaultKind::corrupt:
                flip_bit(heard.frame, active.fault.bit);
                break;
            case CanFaultKind::delay:
                heard.end = later(heard.end, active.fault.delay_us);
                break;
        }
    }
    for (int i = 0; i < times; ++i) heard_.emplace(heard.end, heard);
}

void SimulatedCanBus::deliver_due(SimTime time) {
    now_ = std::max(now_, time);
    while (!heard_.empty() && heard_.begin()->first <= time) {
        const Transmission heard = heard_.extract(heard_.begin()).mapped();
        deliver(heard);
    }
}

void SimulatedCanBus::deliver(const Transmission& heard) {
    for (const FrameHandler& tap : taps_) tap(heard.frame, heard.end);
    for (const Controller& controller : controllers_) {
        if (!controller.is_on_bus(now_)) continue;
        if (&controller != heard.sender && controller.on_frame) controller.on_frame(heard.frame, heard.end);
    }
}

bool SimulatedCanBus::start_transmission(SimTime now) {
    const auto given = earliest_given();
    if (!given) return false;
    const SimTime start = std::max(*given, idle_since_);
    if (start > now) return false;

    Controller* winner = nullptr;
    std::vector<Pending>::iterator winning;
    for (Controller& controller : controllers_) {
        if (!controller.is_on_bus(start)) continue;
        for (auto it = controller.pending.begin(); it != controller.pending.end(); ++it) {
            if (it->given > start) continue;
            if (winner != nullptr && winning->frame.can_id <= it->frame.can_id) continue;
            winner = &controller;
            winning = it;
        }
    }
    const std::int64_t duration = frame_duration_us(winning->frame, rates_);
    under_way_ = {.frame = winning->frame, .sender = winner, .end = later(start, duration)};
    busy_us_ += duration;
    winner->pending.erase(winning);
    return true;
}

std::optional<SimTime> SimulatedCanBus::earliest_given() const {
    std::optional<SimTime> earliest;
    for (const Controller& controller : controllers_) {
        if (!controller.is_on_bus(now_)) continue;
        for (const Pending& pending : controller.pending) {
            if (!earliest || pending.given < *earliest) earliest = pending.given;
        }
    }
    return earliest;
}

std::optional<SimTime> SimulatedCanBus::next_event() const {
    std::optional<SimTime> next;
    const auto consider = [&](SimTime time) {
        if (!next || time < *next) next = time;
    };
    if (!heard_.empty()) consider(heard_.begin()->first);
    for (const Controller& controller : controllers_) {
        if (controller.back_at() && *controller.back_at() > now_) consider(*controller.back_at());
    }
    if (under_way_) {
        consider(under_way_->end);
    } else if (const auto given = earliest_given()) {
        consider(std::max({*given, idle_since_, now_}));
    }
    return next;
}

double SimulatedCanBus::busy_fraction() const {
    if (now_.us <= 0) return 0.0;
    std::int64_t busy = busy_us_;
    if (under_way_) busy -= std::max<std::int64_t>(0, under_way_->end.us - now_.us);
    return static_cast<double>(busy) / static_cast<double>(now_.us);
}

}  // namespace octoskin::sim
