// Saves maps in its own thread, one save at a time.
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

/// Why a map cannot be kept with this mapping: it takes more than `next.memory_max_mib`, and the next start
/// would refuse it. Empty: it can.
[[nodiscard]] std::optional<Error> why_no_room(const FusedMap& map, const MapConfig& next);

struct SaveRecord {
    std::uint64_t saved = 0;
    std::uint64_t failed = 0;
    std::uint64_t skipped = 0;  ///< requested while another save was in progress
    std::optional<HostTime> newest;
    std::string error;                          ///< of the newest save; empty if it succeeded
    std::optional<HostTime> saving_since = {};  ///< start of the save in progress; empty: none is
};

/// A loaded map.
struct KeptMap {
    FusedMap map;
    std::vector<std::string> warnings;  ///< for a person
    /// With counts and times, from a snapshot; else only log-odds, of unknown age.
    bool is_whole = false;
    std::optional<BootTime> map_time = {};  ///< of a whole one: the instant of the map's time
    std::uint32_t placement_crc32 = 0;      ///< of a whole one: as in its SnapshotOrigin
};

/// Completes a save that was killed after fused.ot was put in place, and before fused.snapshot was. True if
/// there was one: its draft of the snapshot, which has the checksum of the present fused.ot, was put in
/// place. For a folder that no daemon holds. O(bytes of fused.ot) if there is a draft.
bool finish_save(const OpenFolder& folder);

class MapSaver {
  public:
    /// Writes a map into the folder; the result is empty, or the error. `origin`: complete except for the
    /// checksum of the .ot.
    using Writer = std::function<std::string(const FusedMap& map, const SnapshotOrigin& origin,
                                             const NamedFolder& folder)>;

    using Copier = std::function<FusedMap(const FusedMap& map)>;

    /// `folder` gets fused.ot, fused.bt and fused.snapshot; this process must hold it (FolderLock).
    explicit MapSaver(NamedFolder folder, Writer writer = write_map, Copier copier = &FusedMap::copy);
    /// A save on a disk that hangs is left behind: call `finish` first.
    ~MapSaver();
    MapSaver(const MapSaver&) = delete;
    MapSaver& operator=(const MapSaver&) = delete;

    /// The map to continue with. That is fused.snapshot, if it belongs to `mapping`, whose text has this
    /// checksum, and was saved with the present fused.ot. Else, with a warning that names the reason, it is
    /// fused.ot, checked as every foreign map, or fused.bt if that is the only file. Empty if there is
    /// neither. An error names the file, the fault and the remedy. Any map that a MapSaver with this
    /// memory_max_mib saved has room. Files that the next save would destroy are refused, too: one with
    /// colours of voxels, and a fused.bt that octoskin did not save and fused.ot does not contain. Remains of
    /// a killed save are removed, except a snapshot of the present fused.ot: that save is completed.
    [[nodiscard]] Result<std::optional<KeptMap>, AppError> load(const MappingConfig& mapping,
                                                                std::uint32_t mapping_crc32 = 0) const;

    /// Size of the files that `load` may read, bytes.
    [[nodiscard]] std::uint64_t saved_bytes() const;

    /// From the next save on, maps go into this folder, which this process must hold. A save in progress
    /// still goes into the former one.
    void move_to(NamedFolder folder);

    /// Copies the map and has the copy saved, without waiting for the disk. While a save is in progress
    /// nothing is copied, and the result is false: there is one copy at a time. False, too, if there is no
    /// memory for it: counted as failed, and the next save is tried as usual.
    bool save(const FusedMap& map, const SnapshotOrigin& origin = {}) {
        return save(map, [&origin](FusedMap&) { return origin; });
    }
    /// `make_ready` gets the copy before it is written, and returns its origin.
    using MakeReady = std::function<SnapshotOrigin(FusedMap& copy)>;
    bool save(const FusedMap& map, const MakeReady& make_ready);
    /// Saves the map itself, which needs no memory for a copy: the last save. Call `finish` first; asserted.
    void save_last(FusedMap map, const SnapshotOrigin& origin = {});
    /// Waits until no save is left, at most `patience`; false if that was too short.
    [[nodiscard]] bool finish(Nanoseconds patience);

    [[nodiscard]] SaveRecord record() const;

    /// Writes all three files or, if one cannot be written, none. If the process is killed meanwhile, `load`
    /// finds the complete former map or the complete new one. Needs disk space for both. Throws
    /// std::bad_alloc.
    static std::string write_map(const FusedMap& map, const SnapshotOrigin& origin,
                                 const NamedFolder& folder);

  private:
    struct Save {
        FusedMap map;
        SnapshotOrigin origin;
    };
    /// State shared with the thread, which may outlive the MapSaver.
    struct Work {
        Work(NamedFolder folder_in, Writer writer_in)
            : folder(std::move(folder_in)), writer(std::move(writer_in)) {}
        NamedFolder folder;
        Writer writer;
        std::mutex mutex;
        std::condition_variable changed;
        std::optional<Save> waiting;
        bool is_busy = false;  ///< from `save` until it is written
        bool is_ending = false;
        SaveRecord record;
    };
    [[nodiscard]] Result<std::optional<KeptMap>, AppError> find(const MappingConfig& mapping,
                                                                std::uint32_t mapping_crc32) const;
    /// Called if fused.ot exists.
    [[nodiscard]] Result<KeptMap, AppError> load_with(const MappingConfig& mapping,
                                                      std::uint32_t mapping_crc32) const;
    static void work(Work& shared);
    static void end_save(Work& shared, std::string error);

    Copier copier_;
    std::shared_ptr<Work> work_;
    std::thread thread_;
};

}  // namespace octoskin
