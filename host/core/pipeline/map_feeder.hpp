// Applies the evidence of one measurement to the maps that are built at the same time.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "common/time.hpp"
#include "host/core/mapping/evidence_sink.hpp"
#include "host/core/pipeline/commit.hpp"
#include "host/core/pipeline/fed_map.hpp"

namespace octoskin {

/// Takes the evidence of one measurement captured at `now`, for each map that uses its sensor.
class MapFeeder final : public EvidenceSink {
  public:
    /// `changes`: gets the change of the log-odds in the map of both sensors, each voxel once; for `terms`,
    /// the terms. `listener`: notified of the maps' time. Either may be null.
    MapFeeder(std::span<FedMap> maps, HostTime now, std::vector<VoxelUpdate>* changes,
              CommitListener* listener) noexcept
        : maps_(maps), now_(now), changes_(changes), listener_(listener) {}

    /// O(maps) more than FusedMap::apply. Throws only if `changes` is given.
    void apply(const Evidence& evidence, const std::function<bool(VoxelKey)>* spares) override;
    [[nodiscard]] bool is_occupied(VoxelKey key) const override;

  private:
    void add_change(const VoxelUpdate& change);

    std::span<FedMap> maps_;
    HostTime now_;
    std::vector<VoxelUpdate>* changes_;
    CommitListener* listener_;
    bool has_begun_ = false;
};

}  // namespace octoskin
