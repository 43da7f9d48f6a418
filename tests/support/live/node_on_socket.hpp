// A simulated node at the other end of a socketpair: the real node core and driver, simulated sensors. It
// runs in real time, also while the host waits.
#pragma once

#include <optional>
#include <vector>

#include "host/apps/node_session/node_session.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::test {

class NodeOnSocket {
  public:
    explicit NodeOnSocket(const NodeConfig& config, const std::vector<SensorSetup>& setups);

    [[nodiscard]] Outside outside();
    [[nodiscard]] socketcan::CanSocket& host() { return *host_; }
    [[nodiscard]] NodeRig& rig() { return rig_; }
    /// Every frame of the host so far, decoded or not.
    [[nodiscard]] const std::vector<wire::CanFrame>& heard() const noexcept { return heard_; }
    /// From now on frames of the node do not reach the host, or frames of the host do not reach the node.
    void cut_way_out() { is_way_out_cut_ = true; }
    void cut_way_in() { is_way_in_cut_ = true; }
    /// From now on a reset that is ordered is not performed.
    void ignore_resets() { performs_resets_ = false; }

  private:
    void step();
    NodeRig rig_;
    std::vector<wire::CanFrame> heard_;
    bool is_way_out_cut_ = false;
    bool is_way_in_cut_ = false;
    bool performs_resets_ = true;
    std::optional<socketcan::CanSocket> host_;
    std::optional<socketcan::CanSocket> node_;
};

}  // namespace octoskin::test
