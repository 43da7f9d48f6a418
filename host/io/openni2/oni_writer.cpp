#include "host/io/openni2/oni_writer.hpp"

#include <cassert>
#include <string>
#include <vector>

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kWritePatience{30'000};
/// Typically 3 ms on an idle machine.
constexpr std::chrono::milliseconds kPatiencePerFrame{100};
constexpr const char* kWriteHelper = "octoskin-oni-write";

}  // namespace

Unexpected<Error> OniWriter::failure(const std::string& what) const {
    return unexpected(in_file({ErrorCode::system_error, what}, oni_.shown()));
}

Result<OniWriter, Error> OniWriter::create(const FilePlace& oni, const FilePlace& epoch, FrameSize size,
                                           std::optional<std::filesystem::path> helper) {
    const auto failure = [&oni](ErrorCode code, const std::string& what) {
        return unexpected(in_file({code, what}, oni.shown()));
    };
    if (size.pixels() == 0 || size.pixels() > kPixelsMax || size.width > kSideMax || size.height > kSideMax) {
        return failure(ErrorCode::limit_exceeded,
                       "OpenNI2 cannot record images of " + std::to_string(size.width) + " x " +
                           std::to_string(size.height) + " pixels, only up to 1600 x 1200");
    }
    const auto program = find_helper(kWriteHelper, helper);
    if (!program) return failure(ErrorCode::no_program, program.error());
    // An old sidecar must not make an unfinished recording look complete.
    const auto sidecar = epoch.parent_to_write();
    if (!sidecar) return unexpected(to_error(sidecar.error()));
    if (const auto removed = sidecar->remove(epoch.filename()); !removed)
        return unexpected(to_error(removed.error()));
    const auto created = oni.create_anew();
    if (!created) return unexpected(in_file(to_error(created.error()), oni.shown()));
    // The helper opens this file itself, even if the name of file or folder changes meanwhile, and continues
    // with it if this process is killed.
    const auto file = path_of_descriptor(HelperProcess::kInherited);
    auto process = HelperProcess::start(*program, {file.string(), oni.shown().string()},
                                        HelperPipe::its_input, HelperComplaints::kept, created->descriptor());
    if (!process) return failure(ErrorCode::no_program, process.error());
    if (const auto written = FramePipe(process->descriptor(), kWritePatience).write_header({.size = size});
        !written) {
        return failure(ErrorCode::system_error, name(written.error()));
    }
    return OniWriter(oni, epoch, size, std::move(*process));
}

/// The helper's last message is more specific than its exit status.
std::string OniWriter::why(const std::string& how) {
    const std::string complaint = helper_.complaint();
    return complaint.empty() ? how : complaint;
}

Status<Error> OniWriter::write(HostTime captured, std::span<const std::uint16_t> depth_mm) {
    assert(depth_mm.size() == size_.pixels());
    const HostTime whole_us{captured.ns / 1000 * 1000};
    if (epoch_.frames == 0) epoch_.first_frame = whole_us;
    assert(whole_us >= epoch_.first_frame);
    std::vector<std::uint16_t> storable(depth_mm.begin(), depth_mm.end());
    for (std::uint16_t& depth : storable) {
        if (depth > kDepthMaxMm) depth = 0;
    }
    const auto since_first = static_cast<std::uint64_t>((whole_us - epoch_.first_frame).count() / 1000);
    const auto written = FramePipe(helper_.descriptor(), kWritePatience).write_frame(since_first, storable);
    if (!written) return failure(why(name(written.error())));
    ++epoch_.frames;
    return Done{};
}

Status<Error> OniWriter::close() {
    if (const auto written = FramePipe(helper_.descriptor(), kWritePatience).write_end(); !written) {
        return failure(why(name(written.error())));
    }
    helper_.close_pipe();
    const auto patience = kWritePatience + kPatiencePerFrame * static_cast<std::int64_t>(epoch_.frames);
    if (const auto how = helper_.wait(patience)) return failure("the recorder failed: " + why(*how));
    return write_epoch(epoch_file_, epoch_);
}

}  // namespace octoskin::openni2
