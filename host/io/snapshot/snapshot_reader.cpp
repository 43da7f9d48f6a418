#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <utility>

#include "host/io/snapshot/blocks.hpp"
#include "host/io/snapshot/brick_records.hpp"
#include "host/io/snapshot/camera_records.hpp"
#include "host/io/snapshot/reading_records.hpp"
#include "host/io/snapshot/snapshot.hpp"

namespace octoskin {
namespace {

using namespace snapshot;

/// The largest log-odds in a mapping file.
constexpr float kLogOddsMax = 100.0F;

bool is_log_odds(float value) {
    if (std::isnan(value))
        return std::bit_cast<std::uint32_t>(value) == std::bit_cast<std::uint32_t>(kUnknownLogOdds);
    return std::fabs(value) <= kLogOddsMax;
}

bool is_count(float value) {
    return std::isfinite(value) && value >= 0.0F;
}

std::size_t known_voxels_of(const BrickTree& log_odds) {
    std::size_t known = 0;
    log_odds.for_each([&](MortonCode, const BrickView& view) {
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) known += std::isnan(view.at(cell)) ? 0U : 1U;
    });
    return known;
}

/// Hits and misses have the same bricks; the prior has some of these, and no others.
bool are_of_one_layer(const CountLayer& counts) {
    bool are = counts.hits.bricks() == counts.misses.bricks();
    counts.misses.for_each([&](MortonCode brick, const BrickView&) { are = are && counts.has(brick); });
    counts.prior.for_each([&](MortonCode brick, const BrickView&) { are = are && counts.has(brick); });
    return are;
}

struct Head {
    SnapshotOrigin origin;
    double resolution_m = 0.0;
    bool has_undated = false;
    VoxelAges::Clock clock;
};

/// Empty if it is not valid.
std::optional<Head> read_head(const Block& block) {
    ByteReader reader(block.payload);
    Head head;
    head.origin.mapping_crc32 = reader.get<std::uint32_t>();
    head.origin.placement_crc32 = reader.get<std::uint32_t>();
    head.resolution_m = reader.get<double>();
    const bool has_map = reader.get_flag();
    const auto map_crc32 = reader.get<std::uint32_t>();
    if (has_map) head.origin.map_crc32 = map_crc32;
    const bool has_time = reader.get_flag();
    BootTime time;
    for (std::uint8_t& byte : time.boot) byte = reader.get<std::uint8_t>();
    time.since_boot = Nanoseconds{reader.get<std::int64_t>()};
    if (has_time) head.origin.map_time = time;
    head.has_undated = reader.get_flag();
    head.clock.has_begun = reader.get_flag();
    head.clock.waits = reader.get_flag();
    head.clock.runs_for_s = reader.get<std::int64_t>();
    head.clock.waited_s = reader.get<std::int64_t>();
    head.clock.zero_s = reader.get<std::int64_t>();
    head.clock.now = reader.get<std::uint32_t>();
    const bool is_possible = reader.is_sound() && reader.is_over() && VoxelAges::is_possible(head.clock) &&
                             time.since_boot >= Nanoseconds{0};
    return is_possible ? std::optional(head) : std::nullopt;
}

class Decoder {
  public:
    Decoder(std::string_view bytes, const MappingConfig& mapping, std::uint32_t mapping_crc32)
        : bytes_(bytes), mapping_(mapping), mapping_crc32_(mapping_crc32), blocks_(bytes) {}

    Result<Snapshot, Error> decode() {
        if (!blocks_.has_magic()) return no_snapshot();
        while (!is_done_) {
            const auto block = blocks_.next();
            if (!block) return fail(ErrorCode::damaged, blocks_.at(), "no complete and undamaged block");
            if (has_head_ == (block->kind == BlockKind::head))
                return fail(ErrorCode::damaged, block->at, "not exactly one head at the beginning");
            if (const auto taken = take(*block); !taken) return unexpected(taken.error());
        }
        if (!blocks_.is_over()) return fail(ErrorCode::damaged, blocks_.at(), "bytes after the end");
        FusedMap map(mapping_.map, std::move(layers_), has_undated_);
        return Snapshot{origin_, {std::move(map), std::move(histories_), cameras_.memories()}};
    }

  private:
    using Taken = Status<Error>;

    static Unexpected<Error> fail(ErrorCode code, std::size_t at, std::string_view what) {
        return unexpected(Error{code, fmt::format("byte {}: {}", at, what)});
    }
    Unexpected<Error> no_snapshot() const {
        const std::string_view name = kMagic.substr(0, kMagic.size() - 1);
        const bool is_other = bytes_.size() >= kMagic.size() && bytes_.starts_with(name);
        return fail(is_other ? ErrorCode::unsupported : ErrorCode::foreign_format, 0,
                    fmt::format("does not begin with '{}'", kMagic));
    }

    Taken take(const Block& block) {
        const auto is_stamp = [this](std::uint16_t stamp) { return VoxelAges::is_possible(stamp, clock_); };
        switch (block.kind) {
            case BlockKind::head:
                return take_head(block);
            case BlockKind::log_odds:
                return within_limit(block, log_odds_.take(block.payload, is_log_odds));
            case BlockKind::prior:
                return within_limit(block, prior_.take(block.payload, is_log_odds));
            case BlockKind::misses:
                return within_limit(block, misses_.take(block.payload, is_count));
            case BlockKind::hits:
                return within_limit(block, hits_.take(block.payload, is_count));
            case BlockKind::ages:
                return within_limit(block, ages_.take(block.payload, is_stamp));
            case BlockKind::confirmed:
                return records(block, readings_.take_confirmed(block.payload, mapping_.standing));
            case BlockKind::seen:
                return records(block, readings_.take_seen(block.payload));
            case BlockKind::camera:
                return within_limit(block, cameras_.take(block.payload));
            case BlockKind::done:
                return take_done(block);
        }
        return fail(ErrorCode::damaged, block.at, "a block of an unknown kind");
    }
    static Taken records(const Block& block, bool are_taken) {
        if (are_taken) return Done{};
        return fail(ErrorCode::damaged, block.at,
                    fmt::format("the block {} has an invalid record", tag_of(block.kind)));
    }
    Taken within_limit(const Block& block, BlockRead read) const {
        if (read != BlockRead::no_room) return records(block, read == BlockRead::all);
        return fail(ErrorCode::too_large, block.at,
                    fmt::format("it needs more memory than the {} MiB of map.memory_max_mib",
                                mapping_.map.memory_max_mib));
    }

    Taken take_head(const Block& block) {
        const auto head = read_head(block);
        if (!head) return records(block, false);
        origin_ = head->origin;
        has_undated_ = head->has_undated;
        clock_ = head->clock;
        has_head_ = true;
        if (head->resolution_m != mapping_.map.resolution_m)
            return fail(ErrorCode::mismatch, block.at,
                        fmt::format("its voxels are {} m, the mapping's are {} m", head->resolution_m,
                                    mapping_.map.resolution_m));
        if (origin_.mapping_crc32 != mapping_crc32_)
            return fail(
                ErrorCode::mismatch, block.at,
                fmt::format("it belongs to the mapping with CRC-32 {:08x}, the present one has {:08x}",
                            origin_.mapping_crc32, mapping_crc32_));
        return Done{};
    }

    Taken take_done(const Block& block) {
        ByteReader reader(block.payload);
        layers_.ages = VoxelAges(clock_, std::move(stamps_));
        layers_.known_voxels = known_voxels_of(layers_.log_odds);
        const ZoneCounts zones = count_zones(histories_);
        const std::uint64_t are[] = {layers_.log_odds.bricks(),
                                     layers_.counts.prior.bricks(),
                                     layers_.counts.misses.bricks(),
                                     layers_.counts.hits.bricks(),
                                     layers_.ages.stamps().bricks(),
                                     zones.confirmed,
                                     zones.seen};
        bool are_all = true;
        for (const std::uint64_t there : are) are_all = reader.get<std::uint64_t>() == there && are_all;
        is_done_ = true;
        return records(block, are_all && reader.is_sound() && reader.is_over() &&
                                  are_of_one_layer(layers_.counts) && cameras_.is_complete());
    }

    [[nodiscard]] std::size_t bytes_max() const noexcept {
        return std::size_t{mapping_.map.memory_max_mib} << 20U;
    }

    std::string_view bytes_;
    const MappingConfig& mapping_;
    std::uint32_t mapping_crc32_;
    BlockReader blocks_;
    bool has_head_ = false;
    bool is_done_ = false;
    SnapshotOrigin origin_;
    bool has_undated_ = false;
    VoxelAges::Clock clock_;
    MapLayers layers_;
    StampTree stamps_;
    SensorHistories histories_;
    ReadingsTaker readings_{histories_};
    CameraTaker cameras_{mapping_};
    BrickTaker<float> log_odds_{layers_.log_odds, bytes_max()};
    BrickTaker<float> prior_{layers_.counts.prior, bytes_max()};
    BrickTaker<float> misses_{layers_.counts.misses, bytes_max()};
    BrickTaker<float> hits_{layers_.counts.hits, bytes_max()};
    BrickTaker<std::uint16_t> ages_{stamps_, bytes_max()};
};

}  // namespace

Result<Snapshot, Error> decode_snapshot(std::string_view bytes, const MappingConfig& mapping,
                                        std::uint32_t mapping_crc32) {
    return Decoder(bytes, mapping, mapping_crc32).decode();
}

std::optional<SnapshotOrigin> origin_of_snapshot(std::string_view bytes) {
    BlockReader blocks(bytes);
    if (!blocks.has_magic()) return std::nullopt;
    const auto block = blocks.next();
    if (!block || block->kind != BlockKind::head) return std::nullopt;
    const auto head = read_head(*block);
    return head ? std::optional(head->origin) : std::nullopt;
}

}  // namespace octoskin
