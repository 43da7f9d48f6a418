#include "host/io/candump/log_writer.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include "common/wire/interface_name.hpp"

namespace octoskin::candump {

Result<LogWriter, LogError> LogWriter::create(const FilePlace& file, std::string interface) {
    if (!wire::is_interface_name(interface))
        return unexpected(
            LogError{file.shown(), "'" + interface + "': " + std::string(wire::kInterfaceNameRule)});
    const auto created = file.create_anew();
    if (!created) return unexpected(LogError{file.shown(), "cannot create: " + created.error().reason()});
    errno = 0;
    std::ofstream stream(created->path_for_libraries(), std::ios::binary);
    if (!stream)
        return unexpected(LogError{file.shown(), std::string("cannot create: ") + std::strerror(errno)});
    return LogWriter(file.shown(), std::move(stream), std::move(interface));
}

Status<LogError> LogWriter::write(WallTime stamp, const wire::CanFrame& frame) {
    entry_.stamp = stamp;
    entry_.frame = frame;
    const std::string line = format_line(entry_);
    if (!stream_.write(line.data(), static_cast<std::streamsize>(line.size()))) {
        return unexpected(LogError{file_, "writing failed; is the disk full?"});
    }
    return Done{};
}

Status<LogError> LogWriter::close() {
    stream_.close();
    if (!stream_) {
        return unexpected(LogError{file_, "writing failed; is the disk full?"});
    }
    return Done{};
}

}  // namespace octoskin::candump
