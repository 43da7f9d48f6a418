#include "host/apps/daemon/record_requests.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kStart = "record start ";
constexpr std::string_view kStop = "record stop ";
constexpr double kSecondsMax = 1e6;

bool is_control(char c) {
    constexpr unsigned char kDelete = 0x7F;
    return static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) == kDelete;
}

/// With its control characters as "\\x0a".
std::string in_one_line(const std::string& name) {
    std::string line;
    for (const char c : name) line += is_control(c) ? fmt::format("\\x{:02x}", c) : std::string(1, c);
    return line;
}

}  // namespace

std::string fault_of_folder(const std::filesystem::path& folder) {
    const std::string name = folder.string();
    if (std::ranges::any_of(name, is_control)) {
        return "'" + in_one_line(name) +
               "': a recording's folder may have no control characters in its name; give another one";
    }
    return folder.is_absolute() ? std::string() : "'" + name + "' is no absolute path";
}

std::filesystem::path plain(const std::filesystem::path& folder) {
    std::filesystem::path normal = folder.lexically_normal();
    return normal.has_filename() ? normal : normal.parent_path();
}

std::string RecordRequests::answer(const std::string& line, const RecordedSettings& settings,
                                   Pipeline& pipeline, HostTime now) {
    std::string error;
    if (line.starts_with(kStart)) {
        error = start(line.substr(kStart.size()), settings, pipeline, now);
    } else if (line == "record stop") {
        if (!recorder_) error = "nothing is being recorded";
        stop(now);
    } else if (line.starts_with(kStop)) {
        error = stop(line.substr(kStop.size()), now);
    } else if (line != "record status") {
        error =
            "unknown request; there are: record start SECONDS FOLDER, record stop [FOLDER], record status";
    }
    nlohmann::ordered_json answer{{"ok", error.empty()}};
    if (!error.empty()) answer["error"] = error;
    answer["recording"] = to_json(now);
    answer["before"] = before_;
    return answer.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string RecordRequests::start(const std::string& arguments, const RecordedSettings& settings,
                                  Pipeline& pipeline, HostTime now) {
    double seconds = 0.0;
    const char* const last = arguments.data() + arguments.size();
    const auto [end, error] = std::from_chars(arguments.data(), last, seconds);
    const bool is_time = error == std::errc{} && seconds >= 0.0 && seconds <= kSecondsMax;
    if (!is_time || end == last || *end != ' ') return "expected: record start SECONDS FOLDER";
    const std::filesystem::path named(end + 1, last);
    if (std::string fault = fault_of_folder(named); !fault.empty()) return fault;
    const std::filesystem::path folder = plain(named);
    if (recorder_ && !recorder_->has_ended())
        return "already recording to " + recorder_->folder().string() +
               "; `octoskin record --stop` ends that";
    const auto limit = seconds > 0.0 ? std::optional(Nanoseconds{std::llround(seconds * 1e9)}) : std::nullopt;
    if (recorder_) before_ = to_json(now);
    recorder_.reset();  // the one before lets go of the pipeline first
    refusal_.clear();
    try {
        recorder_ = std::make_unique<Recorder>(folder, limit, settings, pipeline, now, copier_);
        ++begun_;
    } catch (const std::bad_alloc&) {
        refusal_ = fmt::format("no memory for a copy of the map ({} MiB), with which a recording begins",
                               pipeline.maps().fused()->memory_bytes() >> 20U);
    } catch (const std::system_error& error_thrown) {
        refusal_ = fmt::format("no thread to be had for a recording ({})", error_thrown.code().message());
    }
    return refusal_;
}

std::string RecordRequests::stop(const std::string& folder, HostTime now) {
    if (std::string fault = fault_of_folder(folder); !fault.empty()) return fault;
    if (!recorder_) return "nothing is being recorded";
    const std::filesystem::path named = plain(folder);
    if (recorder_->folder() != named) {
        return fmt::format("{} is not being recorded; the recording {} {}", named.string(),
                           recorder_->has_ended() ? "that ended last is" : "goes to",
                           recorder_->folder().string());
    }
    stop(now);
    return {};
}

nlohmann::ordered_json RecordRequests::to_json(HostTime now) const {
    if (!recorder_) return nullptr;
    nlohmann::ordered_json json = recorder_->to_json(now);
    json["number"] = begun_;
    return json;
}

void RecordRequests::finish(Nanoseconds patience) {
    if (!recorder_ || recorder_->has_ended()) return;
    if (!recorder_->wait(patience)) spdlog::error("the recording is not whole: the disk took too long");
    recorder_->attend(monotonic_now());
}

}  // namespace octoskin
