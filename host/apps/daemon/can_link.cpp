#include "host/apps/daemon/can_link.hpp"

#include <linux/can/error.h>

#include <cerrno>
#include <utility>

namespace octoskin {

using socketcan::Received;
using socketcan::SocketFault;

bool CanLink::attend(HostTime now) {
    if (socket_) ask_kernel(now);
    if (socket_ || (tried_ && now - *tried_ < kRetry)) return false;
    tried_ = now;
    auto opened = opener_();
    if (!opened) {
        on_fault(opened.error());
        return false;
    }
    counts_.reopened += std::exchange(was_open_, true) ? 1U : 0U;
    socket_ = std::move(opened).value();
    set(LinkState::up, {});
    return true;
}

std::optional<Received> CanLink::receive(int& datagrams_left) {
    while (socket_ && datagrams_left > 0) {
        auto received = socket_->receive(datagrams_left);
        if (!received) {
            on_fault(received.error());
            return std::nullopt;
        }
        if (!received->has_value()) return std::nullopt;
        if ((*received)->entry.frame.is_error) {
            if (state_ == LinkState::down) set(LinkState::up, {});
            on_error_frame((*received)->entry.frame);
            continue;
        }
        on_traffic((*received)->is_own);
        ++counts_.received;
        return std::move(received).value();
    }
    return std::nullopt;
}

bool CanLink::send(const wire::CanFrame& frame) {
    if (!socket_) {
        ++counts_.not_sent;
        return false;
    }
    const auto sent = socket_->send(frame);
    if (sent && *sent) {
        ++counts_.sent;
        if (state_ == LinkState::down) set(LinkState::up, {});
        return true;
    }
    ++counts_.not_sent;
    if (!sent) on_fault(sent.error());
    return false;
}

void CanLink::on_fault(const SocketFault& fault) {
    if (fault.is_down()) {
        counts_.went_down += state_ == LinkState::down ? 0U : 1U;
        set(LinkState::down, fault.message());
        return;
    }
    close();
    set(LinkState::absent, fault.message());
}

void CanLink::change_filters(Opener opener, std::span<const socketcan::IdFilter> filters) {
    opener_ = std::move(opener);
    if (socket_ && socket_->set_filters(filters)) return;
    tried_.reset();
    close();
}

void CanLink::close() {
    if (!socket_) return;
    counts_.dropped += socket_->dropped();
    counts_.malformed += socket_->malformed();
    if (on_close_) on_close_();
    socket_.reset();
}

/// By <linux/can/error.h> the identifier is a set of classes, and the second byte holds the controller's
/// problem.
void CanLink::on_error_frame(const wire::CanFrame& frame) {
    ++counts_.error_frames;
    const std::uint8_t controller = frame.data[1];
    const bool is_controller = (frame.can_id & CAN_ERR_CRTL) != 0;
    sent_since_error_ = 0;
    if ((frame.can_id & CAN_ERR_BUSOFF) != 0) {
        set_bus_off();
    } else if (is_controller && (controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
        set_error_passive((controller & CAN_ERR_CRTL_TX_PASSIVE) != 0);
    } else if ((frame.can_id & CAN_ERR_RESTARTED) != 0 ||
               (is_controller && (controller & CAN_ERR_CRTL_ACTIVE) != 0)) {
        set(LinkState::up, {});
    }
}

/// Received traffic clears states: a controller that is down or bus-off receives nothing, a receiver leaves
/// error-passive after one frame, and a transmitter after kSentToRecover. Some adapters do not report
/// recovery.
void CanLink::on_traffic(bool is_own) {
    const bool is_passive = state_ == LinkState::error_passive;
    sent_since_error_ += is_own ? 1 : 0;
    const bool has_recovered = is_transmitter_passive_ ? sent_since_error_ >= kSentToRecover : !is_own;
    const bool is_back =
        state_ == LinkState::down || state_ == LinkState::bus_off || (is_passive && has_recovered);
    if (is_back) set(LinkState::up, {});
}

void CanLink::ask_kernel(HostTime now) {
    const Nanoseconds period = state_ == LinkState::down ? kRetry : kAsk;
    if (!state_reader_ || (asked_ && now - *asked_ < period)) return;
    asked_ = now;
    const auto state = state_reader_();
    if (!state) return;
    if (!state->is_up) return on_fault(socket_->fault(ENETDOWN, "cannot receive"));
    if (state_ == LinkState::down) set(LinkState::up, {});
    if (state->controller) believe(*state->controller);
}

void CanLink::believe(socketcan::ControllerState state) {
    using socketcan::ControllerState;
    if (state == ControllerState::bus_off && state_ != LinkState::bus_off) set_bus_off();
    if (state == ControllerState::error_passive && state_ != LinkState::error_passive)
        set_error_passive(true);
    const bool is_active = state == ControllerState::error_active || state == ControllerState::error_warning;
    if (is_active && state_ != LinkState::up) set(LinkState::up, {});
}

void CanLink::set_bus_off() {
    ++counts_.bus_off;
    set(LinkState::bus_off,
        "the adapter is bus-off (`ip link set NAME type can restart-ms 100` lets it come back)");
}

void CanLink::set_error_passive(bool is_transmitter) {
    is_transmitter_passive_ = is_transmitter;
    sent_since_error_ = 0;
    set(LinkState::error_passive,
        "the adapter is error-passive: no node acknowledges, the bit rates differ, or the line is disturbed");
}

void CanLink::set(LinkState state, std::string why) {
    state_ = state;
    why_ = std::move(why);
}

CanLink::Counts CanLink::counts() const {
    Counts counts = counts_;
    if (socket_) {
        counts.dropped += socket_->dropped();
        counts.malformed += socket_->malformed();
    }
    return counts;
}

}  // namespace octoskin
