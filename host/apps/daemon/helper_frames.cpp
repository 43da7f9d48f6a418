#include "host/apps/daemon/helper_frames.hpp"

#include <poll.h>

#include <system_error>
#include <utility>
#include <vector>

#include "host/io/openni2/helper_process.hpp"

namespace octoskin {
namespace {

constexpr const char* kHelper = "octoskin-camera";
constexpr std::chrono::milliseconds kOpenPatience{15'000};  // a real device takes seconds to start

std::string with_complaint(const std::string& what, openni2::HelperProcess& helper) {
    const std::string complaint = helper.complaint();
    return complaint.empty() ? what : what + " (" + complaint + ")";
}

bool is_oni_name(const std::string& uri) {
    return std::filesystem::path(uri).extension() == ".oni";
}

/// Why the file cannot be played; empty if it may be playable.
std::string fault_of_file(const std::string& uri) {
    std::error_code error;
    if (!is_oni_name(uri) || std::filesystem::is_regular_file(uri, error)) return {};
    return uri + (std::filesystem::exists(uri, error) ? ": is not a file" : ": no such file");
}

std::string not_opened(const std::string& uri) {
    if (uri.empty()) return "no camera found: is one plugged in, with an OpenNI2 driver?";
    return uri + (is_oni_name(uri) ? ": no .oni file with depth that OpenNI2 can play"
                                   : ": no camera with depth there");
}

class HelperStream final : public FrameStream {
  public:
    HelperStream(openni2::HelperProcess process, const openni2::StreamHeader& header,
                 std::chrono::milliseconds silence_max, int interrupt)
        : process_(std::move(process)),
          header_(header),
          frames_(process_.descriptor(), silence_max, interrupt) {}

    [[nodiscard]] double rate_hz() const override { return header_.rate_mhz * 1e-3; }
    [[nodiscard]] openni2::FrameSize size() const override { return header_.size; }
    [[nodiscard]] Result<openni2::PipedFrame, std::string> read() override {
        auto frame = frames_.read_frame(header_.size);
        if (frame && frame->has_value()) return std::move(**frame);
        return unexpected(reason(frame ? "it ended" : name(frame.error())));
    }
    [[nodiscard]] std::string reason(const std::string& what) override {
        return with_complaint(what, process_);
    }

  private:
    openni2::HelperProcess process_;
    openni2::StreamHeader header_;
    openni2::FramePipe frames_;
};

}  // namespace

HelperFrames::HelperFrames(std::string uri, std::chrono::milliseconds silence_max,
                           std::optional<std::filesystem::path> helper,
                           std::optional<openni2::CameraMode> mode)
    : uri_(std::move(uri)), silence_max_(silence_max), helper_(std::move(helper)), mode_(mode) {}

bool HelperFrames::may_repeat() const {
    return is_oni_name(uri_);
}

Result<std::unique_ptr<FrameStream>, std::string> HelperFrames::open(int interrupt) {
    pollfd ending{interrupt, POLLIN, 0};
    if (std::exchange(was_tried_, true)) (void)::poll(&ending, 1, static_cast<int>(kRetry.count()));
    if (ending.revents != 0) return unexpected(std::string("cancelled"));
    if (std::string fault = fault_of_file(uri_); !fault.empty()) return unexpected(std::move(fault));
    const auto helper = openni2::find_helper(kHelper, helper_);
    if (!helper) return unexpected(helper.error());
    std::vector<std::string> arguments{uri_};
    if (mode_) arguments.push_back(to_text(*mode_));
    auto process = openni2::HelperProcess::start(*helper, arguments, openni2::HelperPipe::its_output,
                                                 openni2::HelperComplaints::kept);
    if (!process) return unexpected(process.error());
    std::error_code error;
    const auto film_bytes = std::filesystem::file_size(uri_, error);
    const auto patience = kOpenPatience + openni2::time_to_check(error ? 0 : film_bytes);
    const auto header = openni2::FramePipe(process->descriptor(), patience, interrupt).read_header();
    if (!header) return unexpected(with_complaint(not_opened(uri_), *process));
    return std::unique_ptr<FrameStream>(
        std::make_unique<HelperStream>(std::move(process).value(), *header, silence_max_, interrupt));
}

}  // namespace octoskin
