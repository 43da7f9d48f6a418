#include "host/apps/daemon/recording_writer.hpp"

#include <utility>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/io/mapfile/map_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kWritePeriod{100};

Status<std::string> write_file(const fs::path& file, const std::string& text) {
    GrowingFile stream;
    if (const auto created = stream.create(file); !created) return created;
    if (const auto written = stream.append(text); !written) return written;
    return stream.finish();
}

/// Saves the map and gives its checksum; an empty one has neither file nor checksum.
Result<std::optional<std::uint32_t>, std::string> keep_map(const FusedMap& map, const fs::path& file) {
    if (map.known_voxels() == 0) return std::optional<std::uint32_t>{};
    if (const auto saved = save_map(map, file); !saved) return unexpected(saved.error().message);
    const auto crc32 = crc32_of(file);
    if (!crc32) return unexpected(file.string() + ": cannot be read again");
    return crc32;
}

Status<std::string> make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return unexpected(folder.string() + ": " + error.message());
    const bool is_empty = fs::is_empty(folder, error);
    if (error) return unexpected(folder.string() + ": " + error.message());
    if (!is_empty) return unexpected(folder.string() + ": is not empty; give another directory");
    return Done{};
}

}  // namespace

RecordingWriter::RecordingWriter(RecordingBegin begin)
    : begin_(std::move(begin)), depth_(begin_.paths.depth(), begin_.paths.depth_epoch()) {
    thread_ = start_without_signals([this] { work(); });
}

RecordingWriter::~RecordingWriter() {
    {
        const std::lock_guard lock(mutex_);
        is_dropped_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void RecordingWriter::finish(RecordingEnd end) {
    {
        const std::lock_guard lock(mutex_);
        end_ = std::move(end);
    }
    changed_.notify_all();
}

bool RecordingWriter::has_ended() const {
    const std::lock_guard lock(mutex_);
    return has_ended_;
}

std::string RecordingWriter::error() const {
    const std::lock_guard lock(mutex_);
    return error_.empty() ? depth_.error() : error_;
}

bool RecordingWriter::wait(Nanoseconds patience) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [this] { return has_ended_; });
}

void RecordingWriter::work() {
    const Step outcome = record();
    {
        const std::lock_guard lock(mutex_);
        has_ended_ = true;
        if (!outcome) error_ = outcome.error();
    }
    changed_.notify_all();
}

Status<std::string> RecordingWriter::record() {
    if (const Step made = make_folder(begin_.paths.directory); !made) return made;
    // Whoever else writes recordings or maps there takes the same lock.
    const auto lock = FileLock::take(begin_.paths.directory, FileLock::Kind::exclusive);
    if (!lock) return unexpected(begin_.paths.directory.string() + ": another octoskin is writing here");
    if (const Step begun = begin(); !begun) return begun;
    while (!rest()) {
        if (const Step written = write_waiting(); !written) return written;
        if (std::string error = depth_.error(); !error.empty()) return unexpected(std::move(error));
    }
    std::unique_lock guard(mutex_);
    if (!end_) return unexpected(begin_.paths.directory.string() + ": the daemon ended in the middle of it");
    RecordingEnd last = std::move(*std::exchange(end_, std::nullopt));
    guard.unlock();
    return end(std::move(last));
}

Status<std::string> RecordingWriter::begin() {
    const RecordingPaths& paths = begin_.paths;
    const std::pair<fs::path, const std::string&> texts[] = {
        {paths.rig(), begin_.rig}, {paths.robot(), begin_.robot}, {paths.mapping(), begin_.mapping}};
    for (const auto& [file, text] : texts) {
        if (const Step written = write_file(file, text); !written) return written;
    }
    const auto first = keep_map(begin_.first_map, paths.first_map());
    if (!first) return unexpected(first.error());
    begin_.first_map = FusedMap(begin_.first_map.config());  // its memory is not needed any more
    begin_.order.first_map = *first;
    if (const Step created = can_file_.create(paths.can_log()); !created) return created;
    if (const Step created = order_file_.create(paths.order()); !created) return created;
    return order_file_.append(orderlog::format_header(begin_.order));
}

bool RecordingWriter::rest() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kWritePeriod, [this] { return end_ || is_dropped_; });
}

Status<std::string> RecordingWriter::write_waiting() {
    if (const Step written = can_file_.append(can_.take()); !written) return written;
    return order_file_.append(order_.take());
}

Status<std::string> RecordingWriter::end(RecordingEnd last) {
    if (const Step written = write_waiting(); !written) return written;
    if (const Step finished = can_file_.finish(); !finished) return finished;
    if (std::string error = depth_.finish(); !error.empty()) return unexpected(std::move(error));
    const auto map = keep_map(last.last_map, begin_.paths.last_map());
    if (!map) return unexpected(map.error());
    last.order.last_map = *map;
    const std::string text = last.remarks + orderlog::format_trailer(last.order);
    if (const Step written = order_file_.append(text); !written) return written;
    if (const Step finished = order_file_.finish(); !finished) return finished;
    if (const auto written = write_meta(begin_.paths, last.meta); !written)
        return unexpected(written.error().message());
    return Done{};
}

}  // namespace octoskin
