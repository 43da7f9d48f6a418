#include "host/io/openni2/oni_reader.hpp"

#include <algorithm>
#include <string>

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kReadPatience{15'000};
constexpr std::chrono::milliseconds kEndPatience{2'000};
constexpr const char* kReadHelper = "octoskin-oni-read";

std::string with_end(std::string what, const std::optional<std::string>& how_it_ended) {
    if (how_it_ended) what.append(" (").append(kReadHelper).append(": ").append(*how_it_ended).append(")");
    return what;
}

}  // namespace

Result<OniReader, Error> OniReader::open(const FilePlace& oni, const FilePlace& epoch_file,
                                         std::optional<std::filesystem::path> helper) {
    const auto epoch = read_epoch(epoch_file);
    auto reader = start(oni, std::move(helper));
    if (!reader) return reader;
    if (!epoch) return unexpected(epoch.error());
    reader->first_frame_ = epoch->first_frame;
    reader->frames_reported_ = epoch->frames;
    return reader;
}

Result<OniReader, Error> OniReader::open_alone(const FilePlace& oni,
                                               std::optional<std::filesystem::path> helper) {
    return start(oni, std::move(helper));
}

Result<OniReader, Error> OniReader::start(const FilePlace& oni, std::optional<std::filesystem::path> helper) {
    const auto opened = oni.open();
    if (!opened) {
        Error error = to_error(opened.error());
        const FolderFault fault = opened.error().fault;
        const bool is_clear = fault == FolderFault::link || fault == FolderFault::not_a_file;
        if (!is_clear) error.what = "no such file, or not a regular one";
        return unexpected(in_file(std::move(error), oni.shown()));
    }
    const auto program = find_helper(kReadHelper, helper);
    const auto without_reader = [&oni](const std::string& what) {
        return unexpected(in_file({ErrorCode::no_program, what}, oni.shown()));
    };
    if (!program) return without_reader(program.error());
    auto process = HelperProcess::start(
        *program, {path_of_descriptor(HelperProcess::kInherited).string(), oni.shown().string()},
        HelperPipe::its_output, HelperComplaints::on_our_standard_error, opened->descriptor());
    if (!process) return without_reader(process.error());
    std::error_code error;
    const auto size = std::filesystem::file_size(path_of_descriptor(opened->descriptor()), error);
    const auto patience = kReadPatience + time_to_check(error ? 0 : size);
    const auto header = FramePipe(process->descriptor(), patience).read_header();
    if (!header) {
        return unexpected(in_file(
            {ErrorCode::foreign_format,
             with_end("not a recording with depth that OpenNI2 can read", process->wait(kEndPatience))},
            oni.shown()));
    }
    return OniReader(oni.shown(), std::move(*process), *header);
}

Unexpected<Error> OniReader::fail(const std::string& what) {
    const std::string of_all = frames_reported_ ? " of " + std::to_string(*frames_reported_) : "";
    failure_ = in_file(
        {ErrorCode::damaged, what + " after " + std::to_string(frames_read_) + of_all + " frames"}, file_);
    return unexpected(*failure_);
}

Result<std::optional<DepthFrame>, Error> OniReader::next() {
    if (failure_) return unexpected(*failure_);
    if (is_ended_) return std::optional<DepthFrame>{};
    auto piped = FramePipe(helper_.descriptor(), kReadPatience).read_frame(header_.size);
    if (!piped) return fail(with_end(name(piped.error()), helper_.wait(kEndPatience)));
    if (!piped->has_value()) {
        const std::uint64_t reported = frames_reported_.value_or(frames_read_);
        const bool is_short = frames_read_ < reported && !header_.is_salvaged;
        if (is_short || frames_read_ > reported) return fail("the recording ends");
        is_ended_ = true;
        return std::optional<DepthFrame>{};
    }
    if (!(*piped)->is_timed) return fail("a frame without time");
    const auto since_first = static_cast<std::int64_t>((*piped)->timestamp_us);
    constexpr std::int64_t kMaxUs = std::int64_t{1} << 48U;
    if (since_first < 0 || since_first > kMaxUs) return fail("an impossible time stamp");
    const HostTime captured = first_frame_ + Microseconds{since_first};
    if (frames_read_ > 0 && captured < last_) return fail("a time stamp that goes backwards");
    last_ = captured;
    ++frames_read_;
    return std::optional(
        DepthFrame{captured, header_.size.width, header_.size.height, std::move((*piped)->depth_mm)});
}

std::optional<std::string> OniReader::loss() const {
    if (!header_.is_salvaged) return std::nullopt;
    const std::string read = std::to_string(frames_read_);
    if (!frames_reported_) return file_.string() + ": was cut off; " + read + " frames are complete and used";
    return file_.string() + ": was cut off; " + read + " of its " + std::to_string(*frames_reported_) +
           " frames are complete and used, " +
           std::to_string(*frames_reported_ - std::min(*frames_reported_, frames_read_)) + " are lost";
}

}  // namespace octoskin::openni2
