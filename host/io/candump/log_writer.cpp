#include "host/io/candump/log_writer.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include "common/wire/interface_name.hpp"

namespace octoskin::candump {
namespace {

Error write_failed(const std::filesystem::path& file) {
    return {.code = ErrorCode::system_error,
            .what = "writing failed",
            .remedy = "is the disk full?",
            .file = file};
}

}  // namespace

Result<LogWriter, Error> LogWriter::create(const FilePlace& file, std::string interface) {
    if (!wire::is_interface_name(interface))
        return unexpected(Error{.code = ErrorCode::bad_name,
                                .what = std::string(wire::kInterfaceNameRule),
                                .value = "'" + interface + "'",
                                .file = file.shown()});
    const auto created = file.create_anew();
    if (!created) return unexpected(in_file(to_error(created.error(), "cannot create: "), file.shown()));
    errno = 0;
    std::ofstream stream(created->path_for_libraries(), std::ios::binary);
    if (!stream)
        return unexpected(in_file(
            {ErrorCode::system_error, std::string("cannot create: ") + std::strerror(errno)}, file.shown()));
    return LogWriter(file.shown(), std::move(stream), std::move(interface));
}

Status<Error> LogWriter::write(WallTime stamp, const wire::CanFrame& frame) {
    entry_.stamp = stamp;
    entry_.frame = frame;
    const std::string line = format_line(entry_);
    if (!stream_.write(line.data(), static_cast<std::streamsize>(line.size()))) {
        return unexpected(write_failed(file_));
    }
    return Done{};
}

Status<Error> LogWriter::close() {
    stream_.close();
    if (!stream_) {
        return unexpected(write_failed(file_));
    }
    return Done{};
}

}  // namespace octoskin::candump
