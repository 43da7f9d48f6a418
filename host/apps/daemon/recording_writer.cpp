#include "host/apps/daemon/recording_writer.hpp"

#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/depth_recorder.hpp"
#include "host/apps/daemon/growing_file.hpp"
#include "host/apps/daemon/text_queue.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/apps/recording/shortage.hpp"
#include "host/io/snapshot/snapshot_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kWritePeriod{100};
constexpr Nanoseconds kCheckPeriod{1'000'000'000};
constexpr Nanoseconds kDropPatience{100'000'000};

Status<Error> write_file(const FilePlace& file, const std::string& text) {
    GrowingFile stream;
    if (const auto created = stream.create(file); !created) return created;
    if (const auto written = stream.append(text); !written) return written;
    return stream.finish();
}

/// Does not create parents: if a disk is not mounted, hours of a recording would go to another one.
Result<OpenFolder, Error> make_folder(const RecordingPaths& paths) {
    const fs::path& folder = paths.directory;
    std::error_code error;
    if (!fs::exists(folder.parent_path(), error) && !error)
        return unexpected(
            Error{.code = ErrorCode::not_found,
                  .what = "the folder of the recording " + folder.filename().string() + " does not exist",
                  .remedy = "create it, or mount the disk that should be there",
                  .file = folder.parent_path()});
    fs::create_directory(folder, error);
    if (error) return unexpected(to_error(folder_error_of(error.value(), folder)));
    const auto opened = paths.folder.open();
    if (!opened) return unexpected(to_error(opened.error()));
    auto to_write = opened->to_write();
    if (!to_write) return unexpected(to_error(to_write.error()));
    const auto names = to_write->names();
    if (!names) return unexpected(to_error(names.error()));
    if (!names->empty())
        return unexpected(Error{.code = ErrorCode::already_exists,
                                .what = "is not empty",
                                .remedy = "give another directory",
                                .file = folder});
    return std::move(*to_write);
}

}  // namespace

/// State shared with the thread, which may outlive the writer.
class RecordingWriter::Work {
  public:
    Work(RecordingBegin begin, MapWriter map_writer)
        : begin_(std::move(begin)), map_writer_(std::move(map_writer)) {
        for (const std::string& camera : begin_.cameras)
            depth_.push_back(std::make_unique<DepthRecorder>(begin_.paths.depth(camera),
                                                             begin_.paths.depth_epoch(camera)));
    }

    void run();
    void drop();
    void finish(RecordingEnd end);
    [[nodiscard]] bool add_can(const std::string& line) { return can_.add(line); }
    [[nodiscard]] bool add_order(const std::string& line) { return order_.add(line); }
    [[nodiscard]] bool add_depth(const DepthFrame& frame) { return depth_.at(frame.camera)->add(frame); }
    [[nodiscard]] bool has_ended() const;
    [[nodiscard]] std::optional<Error> error() const;
    [[nodiscard]] std::optional<HostTime> writing_since() const;
    [[nodiscard]] bool wait(Nanoseconds patience);
    [[nodiscard]] std::optional<Error> refusal(Nanoseconds patience);
    [[nodiscard]] const fs::path& folder() const { return begin_.paths.directory; }

  private:
    using Step = Status<Error>;
    [[nodiscard]] Step record();
    [[nodiscard]] Step begin();
    [[nodiscard]] Step write_waiting();
    /// Error: the folder or a log in it was removed. A moved folder is still written to.
    [[nodiscard]] Step check(const OpenFolder& held) const;
    /// The same, once a second.
    [[nodiscard]] Step check_sometimes(const OpenFolder& held);
    /// True when `finish` or `drop` requests the end.
    [[nodiscard]] bool rest();
    [[nodiscard]] Step end(RecordingEnd end, const OpenFolder& held);
    [[nodiscard]] Step keep_first();
    [[nodiscard]] Step begin_depth();
    [[nodiscard]] Step finish_depth();
    [[nodiscard]] std::optional<Error> depth_error() const;
    /// Saves the map and returns its checksum; an empty one has neither file nor checksum.
    [[nodiscard]] Result<std::optional<std::uint32_t>, Error> keep_map(const FusedMap& map,
                                                                       const FilePlace& file) const;
    [[nodiscard]] Unexpected<Error> failure(ErrorCode code, const std::string& what) const {
        return unexpected(in_file({code, what}, folder()));
    }

    RecordingBegin begin_;
    MapWriter map_writer_;
    TextQueue can_{kTextMax};
    TextQueue order_{kTextMax};
    std::vector<std::unique_ptr<DepthRecorder>> depth_;  ///< by camera
    GrowingFile can_file_;
    GrowingFile order_file_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<RecordingEnd> end_;
    bool is_dropped_ = false;
    bool has_folder_ = false;  ///< it was empty, and belongs to this user
    bool has_ended_ = false;
    std::optional<Error> error_;
    std::optional<HostTime> writing_since_ = monotonic_now();
    HostTime checked_ = monotonic_now();
};

RecordingWriter::RecordingWriter(RecordingBegin begin, MapWriter map_writer)
    : work_(std::make_shared<Work>(std::move(begin), std::move(map_writer))),
      thread_([shared = work_] { shared->run(); }) {}

RecordingWriter::~RecordingWriter() {
    work_->drop();
    if (!thread_.end(kDropPatience))
        spdlog::error("{}: the disk does not complete the recording; it is left behind",
                      work_->folder().string());
}

bool RecordingWriter::add_can(const std::string& line) {
    return work_->add_can(line);
}
bool RecordingWriter::add_order(const std::string& line) {
    return work_->add_order(line);
}
bool RecordingWriter::add_depth(const DepthFrame& frame) {
    return work_->add_depth(frame);
}
void RecordingWriter::finish(RecordingEnd end) {
    work_->finish(std::move(end));
}
bool RecordingWriter::has_ended() const {
    return work_->has_ended();
}
std::optional<Error> RecordingWriter::error() const {
    return work_->error();
}
bool RecordingWriter::wait(Nanoseconds patience) {
    return work_->wait(patience);
}
std::optional<HostTime> RecordingWriter::writing_since() const {
    return work_->writing_since();
}
std::optional<Error> RecordingWriter::refusal(Nanoseconds patience) {
    return work_->refusal(patience);
}

void RecordingWriter::Work::drop() {
    {
        const std::lock_guard lock(mutex_);
        is_dropped_ = true;
    }
    changed_.notify_all();
}

void RecordingWriter::Work::finish(RecordingEnd end) {
    {
        const std::lock_guard lock(mutex_);
        if (!has_ended_) end_ = std::move(end);  // its map would stay in memory
    }
    changed_.notify_all();
}

bool RecordingWriter::Work::has_ended() const {
    const std::lock_guard lock(mutex_);
    return has_ended_;
}

std::optional<Error> RecordingWriter::Work::error() const {
    const std::lock_guard lock(mutex_);
    return error_ ? error_ : depth_error();
}

std::optional<HostTime> RecordingWriter::Work::writing_since() const {
    const std::lock_guard lock(mutex_);
    return writing_since_;
}

bool RecordingWriter::Work::wait(Nanoseconds patience) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [this] { return has_ended_; });
}

std::optional<Error> RecordingWriter::Work::refusal(Nanoseconds patience) {
    std::unique_lock lock(mutex_);
    (void)changed_.wait_for(lock, patience, [this] { return has_folder_ || has_ended_; });
    return has_folder_ ? std::nullopt : error_;
}

void RecordingWriter::Work::run() {
    Step outcome = Done{};
    try {
        outcome = record();
    } catch (const std::exception& thrown) {  // no memory for the text of a map
        outcome = unexpected(in_file(error_in(thrown), folder()));
    }
    {
        const std::lock_guard lock(mutex_);
        has_ended_ = true;
        writing_since_.reset();
        if (!outcome) error_ = outcome.error();
    }
    changed_.notify_all();
}

Status<Error> RecordingWriter::Work::record() {
    const auto made = make_folder(begin_.paths);
    if (!made) return unexpected(made.error());
    // Other writers of recordings or maps there take the same lock.
    const auto lock = FileLock::take(*made, FileLock::Kind::exclusive);
    if (!lock) return failure(ErrorCode::in_use, "another octoskin is writing here");
    {
        const std::lock_guard guard(mutex_);
        has_folder_ = true;
    }
    changed_.notify_all();
    if (const Step begun = begin(); !begun) return begun;
    if (const Step begun = begin_depth(); !begun) return begun;
    while (!rest()) {
        if (const Step written = write_waiting(); !written) return written;
        if (const Step checked = check_sometimes(*made); !checked) return checked;
        if (auto error = depth_error()) return unexpected(std::move(*error));
    }
    std::unique_lock guard(mutex_);
    if (!end_) return failure(ErrorCode::cancelled, "the daemon ended before the recording was complete");
    RecordingEnd last = std::move(*std::exchange(end_, std::nullopt));
    guard.unlock();
    return end(std::move(last), *made);
}

Result<std::optional<std::uint32_t>, Error> RecordingWriter::Work::keep_map(const FusedMap& map,
                                                                            const FilePlace& file) const {
    if (map.known_voxels() == 0) return std::optional<std::uint32_t>{};
    const auto saved = map_writer_(map, file);
    if (!saved) return unexpected(saved.error());
    return std::optional(*saved);
}

Status<Error> RecordingWriter::Work::keep_first() {
    const auto map = keep_map(begin_.first.map, begin_.paths.first_map());
    if (!map) return unexpected(map.error());
    begin_.order.first_map = *map;
    const SnapshotOrigin origin{.mapping_crc32 = begin_.order.mapping_crc32,
                                .placement_crc32 = begin_.placement_crc32,
                                .map_crc32 = *map};
    const auto saved = save_snapshot(begin_.first, origin, begin_.paths.first_state());
    if (!saved) return unexpected(to_error(saved.error()));
    begin_.order.first_state = *saved;
    begin_.first = {FusedMap(begin_.first.map.config()), {}};  // its memory is no longer needed
    return Done{};
}

Status<Error> RecordingWriter::Work::begin() {
    const RecordingPaths& paths = begin_.paths;
    const std::pair<FilePlace, const std::string&> texts[] = {
        {paths.rig(), begin_.rig}, {paths.robot(), begin_.robot}, {paths.mapping(), begin_.mapping}};
    for (const auto& [file, text] : texts) {
        if (const Step written = write_file(file, text); !written) return written;
    }
    if (const Step kept = keep_first(); !kept) return kept;
    if (const Step created = can_file_.create(paths.can_log()); !created) return created;
    if (const Step created = order_file_.create(paths.order()); !created) return created;
    return order_file_.append(orderlog::format_header(begin_.order));
}

/// Named cameras have a folder of their own.
Status<Error> RecordingWriter::Work::begin_depth() {
    if (std::ranges::any_of(begin_.cameras, [](const std::string& name) { return !name.empty(); })) {
        const auto made = begin_.paths.file(RecordingPaths::kDepthFolder).make_folder();
        if (!made) return unexpected(to_error(made.error()));
    }
    for (const auto& camera : depth_) camera->begin();
    return Done{};
}

Status<Error> RecordingWriter::Work::finish_depth() {
    for (const auto& camera : depth_)
        if (auto error = camera->finish()) return unexpected(std::move(*error));
    return Done{};
}

std::optional<Error> RecordingWriter::Work::depth_error() const {
    for (const auto& camera : depth_)
        if (auto error = camera->error()) return error;
    return std::nullopt;
}

bool RecordingWriter::Work::rest() {
    std::unique_lock lock(mutex_);
    writing_since_.reset();
    const bool is_to_end = changed_.wait_for(lock, kWritePeriod, [this] { return end_ || is_dropped_; });
    writing_since_ = monotonic_now();
    return is_to_end;
}

Status<Error> RecordingWriter::Work::write_waiting() {
    if (const Step written = can_file_.append(can_.take()); !written) return written;
    return order_file_.append(order_.take());
}

Status<Error> RecordingWriter::Work::check(const OpenFolder& held) const {
    struct stat status {};
    if (::fstat(held.descriptor(), &status) != 0)
        return failure(ErrorCode::system_error, std::generic_category().message(errno));
    if (status.st_nlink == 0)
        return failure(ErrorCode::not_found, "was removed while the recording was made");
    if (const Step checked = can_file_.check(); !checked) return checked;
    return order_file_.check();
}

Status<Error> RecordingWriter::Work::check_sometimes(const OpenFolder& held) {
    const HostTime now = monotonic_now();
    if (now - checked_ < kCheckPeriod) return Done{};
    checked_ = now;
    return check(held);
}

Status<Error> RecordingWriter::Work::end(RecordingEnd last, const OpenFolder& held) {
    if (const Step written = write_waiting(); !written) return written;
    if (const Step checked = check(held); !checked) return checked;
    if (const Step finished = can_file_.finish(); !finished) return finished;
    if (const Step finished = finish_depth(); !finished) return finished;
    if (!last.last_map)
        return failure(ErrorCode::no_resources, "there was no memory for a copy of the map at the end");
    const auto map = keep_map(*last.last_map, begin_.paths.last_map());
    if (!map) return unexpected(map.error());
    last.order.last_map = *map;
    const std::string text = last.remarks + orderlog::format_trailer(last.order);
    if (const Step written = order_file_.append(text); !written) return written;
    if (const Step finished = order_file_.finish(); !finished) return finished;
    return write_meta(begin_.paths, last.meta);
}

}  // namespace octoskin
