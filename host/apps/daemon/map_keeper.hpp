// Saves maps while others go on: a thread of its own, one save at a time.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/snapshot/snapshot.hpp"

namespace octoskin {

/// Why a map cannot go on with this mapping: it takes more than `next.memory_max_mib`, and the next start
/// would refuse it. Empty: it can.
[[nodiscard]] std::string why_no_room(const FusedMap& map, const MapConfig& next);

struct SaveRecord {
    std::uint64_t saved = 0;
    std::uint64_t failed = 0;
    std::uint64_t skipped = 0;  ///< asked for while one was being written
    std::optional<HostTime> newest;
    std::string error;                          ///< of the newest save; empty if it went well
    std::optional<HostTime> saving_since = {};  ///< the save that is at work; empty: none is
};

/// A map to go on with.
struct KeptMap {
    FusedMap map;
    std::vector<std::string> warnings;  ///< for a person
    /// With counts and times, from a snapshot; else log-odds alone, and how old they are is not known.
    bool is_whole = false;
    std::optional<BootTime> map_time = {};  ///< of a whole one: when its time was what it is
    std::uint32_t placement_crc32 = 0;      ///< of a whole one: as in its SnapshotOrigin
};

/// A save that was killed when fused.ot was in its place and fused.snapshot was not yet is finished. True if
/// there was one: its draft of the snapshot, which names the fused.ot that is there, came to its place. Of a
/// folder that no daemon keeps. O(bytes of fused.ot) where there is a draft.
bool finish_save(const OpenFolder& folder);

class MapKeeper {
  public:
    /// What writes a map into the folder; the answer is empty, or why it could not. `origin`: but for the
    /// checksum of the .ot.
    using Writer = std::function<std::string(const FusedMap& map, const SnapshotOrigin& origin,
                                             const NamedFolder& folder)>;

    using Copier = std::function<FusedMap(const FusedMap& map)>;

    /// `folder` gets fused.ot, fused.bt and fused.snapshot; it must be this process's own (FolderLock).
    explicit MapKeeper(NamedFolder folder, Writer writer = write_map, Copier copier = &FusedMap::copy);
    /// A save that the disk does not let go of is left behind: `finish` first.
    ~MapKeeper();
    MapKeeper(const MapKeeper&) = delete;
    MapKeeper& operator=(const MapKeeper&) = delete;

    /// The map to go on with: fused.snapshot, if that belongs to `mapping`, whose text has this checksum, and
    /// was saved with the fused.ot that is there; else, with a warning that names the reason, fused.ot,
    /// checked as every foreign map, or fused.bt if that is all there is; empty if neither is there. An error
    /// names the file, what is wrong with it and what to do. Any map that a keeper with this memory_max_mib
    /// saved has room. Refused is, too, what the next save would destroy: colours of voxels, and a fused.bt
    /// that neither octoskin saved nor fused.ot holds. What a dead process left of a save is removed, but for
    /// a snapshot of the fused.ot that is there: a save that had come so far is finished.
    [[nodiscard]] Result<std::optional<KeptMap>, AppError> load(const MappingConfig& mapping,
                                                                std::uint32_t mapping_crc32 = 0) const;

    /// Of the files that `load` may read.
    [[nodiscard]] std::uint64_t saved_bytes() const;

    /// From the next save on maps go into this folder; it must be this process's own. One that is being
    /// written goes where it was to go.
    void move_to(NamedFolder folder);

    /// Copies the map and has the copy saved, never waiting for the disk. While one is being saved nothing is
    /// copied, and false is the answer: there is one copy at a time. False, too, if there is no memory for
    /// it: counted as failed, and the next save is tried as if nothing had been.
    bool save(const FusedMap& map, const SnapshotOrigin& origin = {}) {
        return save(map, [&origin](FusedMap&) { return origin; });
    }
    /// `make_ready` is given the copy before it is written, and says what it is of.
    using MakeReady = std::function<SnapshotOrigin(FusedMap& copy)>;
    bool save(const FusedMap& map, const MakeReady& make_ready);
    /// Saves the map itself, which needs no memory for a copy: the last save. `finish` first; asserted.
    void save_last(FusedMap map, const SnapshotOrigin& origin = {});
    /// Waits until nothing is left to save, `patience` at most; false if that was too short.
    [[nodiscard]] bool finish(Nanoseconds patience);

    [[nodiscard]] SaveRecord record() const;

    /// All three files, or, if one cannot be written, none. A process that is killed in it leaves what `load`
    /// takes for the map of before or for this one, as a whole. Needs the disk's room for both. Throws
    /// std::bad_alloc.
    static std::string write_map(const FusedMap& map, const SnapshotOrigin& origin,
                                 const NamedFolder& folder);

  private:
    struct Save {
        FusedMap map;
        SnapshotOrigin origin;
    };
    /// What the thread needs, for as long as it needs it: it may outlive the keeper.
    struct Work {
        Work(NamedFolder folder_in, Writer writer_in)
            : folder(std::move(folder_in)), writer(std::move(writer_in)) {}
        NamedFolder folder;
        Writer writer;
        std::mutex mutex;
        std::condition_variable changed;
        std::optional<Save> waiting;
        bool is_busy = false;  ///< from `save` on until it is written
        bool is_ending = false;
        SaveRecord record;
    };
    [[nodiscard]] Result<std::optional<KeptMap>, AppError> find(const MappingConfig& mapping,
                                                                std::uint32_t mapping_crc32) const;
    /// fused.ot is there.
    [[nodiscard]] Result<KeptMap, AppError> load_with(const MappingConfig& mapping,
                                                      std::uint32_t mapping_crc32) const;
    static void work(Work& shared);
    static void end_save(Work& shared, std::string error);

    Copier copier_;
    std::shared_ptr<Work> work_;
    std::thread thread_;
};

}  // namespace octoskin
