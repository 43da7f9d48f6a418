#include "host/io/openni2/depth_epoch.hpp"

#include <fstream>
#include <limits>
#include <string>

#include "hw/rigfile/table.hpp"

namespace octoskin::openni2 {
namespace {

constexpr const char* kSchema = "octoskin-depth-epoch/1";

DepthEpoch read_checked(const FilePlace& file) {
    const rig::Value document = rig::load_document(file);
    const rig::Table table(document, "", {"schema", "first_frame_us", "frames"});
    static_cast<void>(table.choice<bool>("schema", {{kSchema, true}}));
    constexpr std::int64_t kUsMax = std::int64_t{1} << 48U;  // the range of FOLLOW_UP
    constexpr std::int64_t kFramesMax =
        std::numeric_limits<std::uint32_t>::max();  // the largest frame number of an .oni
    const auto first_us = table.integer<std::int64_t>("first_frame_us", {0, kUsMax});
    return DepthEpoch{HostTime{first_us * 1000}, table.integer<std::uint64_t>("frames", {0, kFramesMax})};
}

}  // namespace

Status<Error> write_epoch(const FilePlace& file, const DepthEpoch& epoch) {
    const auto created = file.create_anew();
    if (!created) return unexpected(to_error(created.error()));
    std::ofstream out(created->path_for_libraries());
    out << "# The .oni beside this counts its time from its first frame; this is when that was, on the "
           "host's "
           "monotonic clock.\n"
        << "schema: " << kSchema << '\n'
        << "first_frame_us: " << epoch.first_frame.ns / 1000 << '\n'
        << "frames: " << epoch.frames << '\n';
    out.close();
    if (!out) {
        return unexpected(Error{.code = ErrorCode::system_error,
                                .what = "cannot write",
                                .remedy = "is the disk full?",
                                .file = file.shown()});
    }
    return Done{};
}

Result<DepthEpoch, Error> read_epoch(const FilePlace& file) {
    if (const EntryKind kind = file.kind(); kind != EntryKind::file && kind != EntryKind::link)
        return unexpected(in_file(
            {ErrorCode::not_found, "no such file; without it the depth frames have no time"}, file.shown()));
    try {
        return read_checked(file);
    } catch (const Error& error) {
        return unexpected(error);
    }
}

}  // namespace octoskin::openni2
