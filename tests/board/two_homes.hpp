// The demo's experiment without its camera, run with the flashed image on emulated boards or with the node
// core in this process: what was said on the bus, beside what was true.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/wire/messages.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/experiment/experiment.hpp"

namespace octoskin::sim {

using Source = std::pair<std::uint8_t, std::uint8_t>;  ///< node, sensor

/// A reading beside the ranging whose window is nearest to its capture time.
struct JudgedReading {
    wire::RangeReading reading;
    TrueRanging truth;
    std::int64_t error_us = 0;           ///< of its capture time, by the node's clock
    std::int64_t reported_bound_us = 0;  ///< on that error: the one told nearest in time
};

/// A sensor's rangings at one period: from its start to the next.
struct EvenRun {
    std::uint32_t first = 0;  ///< ranging, since power-up
    std::int64_t period_us = 0;
    friend bool operator==(const EvenRun&, const EvenRun&) = default;
};

struct Heard {
    std::map<Source, std::vector<JudgedReading>> readings;
    std::map<Source, std::vector<EvenRun>> runs;
    ExperimentSummary summary;
};

class TwoHomes {
  public:
    /// 2 s at rest, then one revolution in 2 s.
    explicit TwoHomes(SlowClockSpread slow_clocks);

    [[nodiscard]] Heard run_flashed() const;
    /// Its boards start when the other home's did, with the same counters.
    [[nodiscard]] Heard run_core(const std::vector<BoardStart>& starts) const;

  private:
    struct Log;

    [[nodiscard]] Heard run(const std::optional<EmulatedBoards>& emulated,
                            const std::vector<BoardStart>& starts) const;
    void note(Log& log, const wire::CanFrame& frame, WallTime stamp) const;
    [[nodiscard]] Heard judged(const Log& log, const ExperimentSummary& summary) const;
    [[nodiscard]] const NodeClock& clock_of(std::uint8_t node_id, const ExperimentSummary& summary) const;

    rig::Rig rig_;
    Scenario scenario_;
    World world_;
    Arm arm_;
    Body body_;
};

}  // namespace octoskin::sim
