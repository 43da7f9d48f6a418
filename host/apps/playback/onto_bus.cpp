#include "host/apps/playback/onto_bus.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include "host/apps/recording/permission.hpp"
#include "host/io/candump/log_reader.hpp"

namespace octoskin {
namespace {

constexpr std::chrono::seconds kRoomPatience{2};
constexpr std::chrono::microseconds kRoomPeriod{200};

/// Waits until the socket accepts the frame, within the time limit.
Status<AppError> send(socketcan::CanSocket& socket, const wire::CanFrame& frame, OntoBus& played) {
    const auto end = std::chrono::steady_clock::now() + kRoomPatience;
    for (bool is_first = true; std::chrono::steady_clock::now() < end; is_first = false) {
        const auto sent = socket.send(frame);
        if (!sent) {
            return fail(ExitCode::io_failed,
                        in_file({ErrorCode::no_device, sent.error().what}, sent.error().interface));
        }
        if (*sent) {
            ++played.sent;
            played.waited += is_first ? 0U : 1U;
            return Done{};
        }
        std::this_thread::sleep_for(kRoomPeriod);
    }
    return fail(ExitCode::io_failed, {.code = ErrorCode::no_answer,
                                      .what = "no room for a frame in 2 s",
                                      .remedy = "does another node on this bus acknowledge frames?",
                                      .file = socket.interface()});
}

std::string text_of(const candump::LogEntry& entry) {
    std::string line = candump::format_line(entry);
    line.pop_back();
    return line;
}

}  // namespace

Result<OntoBus, AppError> play_onto(const FilePlace& can_log, socketcan::CanSocket& socket, Pace pace,
                                    const OntoReport& report) {
    auto reader = candump::LogReader::open(can_log);
    if (!reader) return unexpected(reading_error(ExitCode::no_input, reader.error()));
    OntoBus played;
    std::optional<WallTime> first;
    while (true) {  // until the end of the log
        const auto entry = reader->next();
        if (!entry) return unexpected(reading_error(ExitCode::bad_data, entry.error()));
        if (!*entry) break;
        const candump::LogEntry& line = **entry;
        if (played.interface.empty()) played.interface = line.interface;
        if (line.interface != played.interface) {
            ++played.other_interface;
        } else if (line.frame.is_error) {
            ++played.error_frames;
        } else {
            if (!first) first = line.stamp;
            if (report) report(played, Nanoseconds{line.stamp.ns - first->ns});
            if (pace.waits()) pace.wait(line.stamp.ns, pace.steps() ? text_of(line) : std::string());
            if (const auto sent = send(socket, line.frame, played); !sent) return unexpected(sent.error());
        }
    }
    played.lines_refused = reader->inputs().rejected();
    if (played.interface.empty()) {
        const Error empty{
            .code = ErrorCode::no_content, .what = "it contains no frame", .file = can_log.shown()};
        return fail(ExitCode::bad_data, reader->foreign_file().value_or(empty));
    }
    return played;
}

}  // namespace octoskin
