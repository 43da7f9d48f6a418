#include "host/apps/daemon/record_requests.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <new>
#include <system_error>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kStart = "record start ";
constexpr double kSecondsMax = 1e6;

}  // namespace

std::string RecordRequests::answer(const std::string& line, const RecordedSettings& settings,
                                   Pipeline& pipeline, HostTime now) {
    std::string error;
    if (line.starts_with(kStart)) {
        error = start(line.substr(kStart.size()), settings, pipeline, now);
    } else if (line == "record stop") {
        if (!recorder_) error = "nothing is being recorded";
        stop(now);
    } else if (line != "record status") {
        error = "unknown request; there are: record start SECONDS FOLDER, record stop, record status";
    }
    nlohmann::ordered_json answer{{"ok", error.empty()}};
    if (!error.empty()) answer["error"] = error;
    answer["recording"] = recorder_ ? recorder_->to_json(now) : nullptr;
    return answer.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string RecordRequests::start(const std::string& arguments, const RecordedSettings& settings,
                                  Pipeline& pipeline, HostTime now) {
    double seconds = 0.0;
    const char* const last = arguments.data() + arguments.size();
    const auto [end, error] = std::from_chars(arguments.data(), last, seconds);
    const bool is_time = error == std::errc{} && seconds >= 0.0 && seconds <= kSecondsMax;
    if (!is_time || end == last || *end != ' ') return "expected: record start SECONDS FOLDER";
    const std::filesystem::path folder(end + 1, last);
    if (!folder.is_absolute()) return "'" + folder.string() + "' is no absolute path";
    if (recorder_ && !recorder_->has_ended())
        return "already recording to " + recorder_->folder().string() +
               "; `octoskin record --stop` ends that";
    const auto limit = seconds > 0.0 ? std::optional(Nanoseconds{std::llround(seconds * 1e9)}) : std::nullopt;
    recorder_.reset();  // the one before lets go of the pipeline first
    refusal_.clear();
    try {
        recorder_ = std::make_unique<Recorder>(folder, limit, settings, pipeline, now, copier_);
    } catch (const std::bad_alloc&) {
        refusal_ = fmt::format("no memory for a copy of the map ({} MiB), with which a recording begins",
                               pipeline.maps().fused()->memory_bytes() >> 20U);
    } catch (const std::system_error& error_thrown) {
        refusal_ = fmt::format("no thread to be had for a recording ({})", error_thrown.code().message());
    }
    return refusal_;
}

void RecordRequests::finish(Nanoseconds patience) {
    if (!recorder_ || recorder_->has_ended()) return;
    if (!recorder_->wait(patience)) spdlog::error("the recording is not whole: the disk took too long");
    recorder_->attend(monotonic_now());
}

}  // namespace octoskin
