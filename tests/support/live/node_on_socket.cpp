#include "tests/support/live/node_on_socket.hpp"

#include <sys/socket.h>

#include <array>
#include <stdexcept>

namespace octoskin::test {

NodeOnSocket::NodeOnSocket(const NodeConfig& config, const std::vector<SensorSetup>& setups)
    : rig_(config, setups) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends.data()) != 0)
        throw std::runtime_error("no pair of sockets");
    host_.emplace("can0", ends[0]);
    node_.emplace("node", ends[1]);
    rig_.run_for(Microseconds{1'000'000});
}

Outside NodeOnSocket::outside() {
    return {[this] { return HostTime{rig_.now().us * 1'000}; }, [this](int, HostTime) { step(); }};
}

void NodeOnSocket::step() {
    while (const auto received = node_->receive().value()) {
        heard_.push_back(received->entry.frame);
        if (!is_way_in_cut_) rig_.send_from_host(received->entry.frame);
    }
    const std::size_t before = rig_.frames().size();
    rig_.run_for(Microseconds{1'000});
    if (performs_resets_ && rig_.node().is_reset_requested())
        rig_.reset({.cause = wire::ResetCause::software});
    for (std::size_t i = before; i < rig_.frames().size(); ++i) {
        const wire::CanFrame& frame = rig_.frames()[i];
        const auto* const spec = wire::frame_spec(wire::type_of(frame.can_id));
        const bool is_the_nodes = spec != nullptr && spec->party == wire::Party::from_node && !frame.is_fd;
        if (is_the_nodes && !is_way_out_cut_) (void)node_->send(frame);
    }
}

}  // namespace octoskin::test
