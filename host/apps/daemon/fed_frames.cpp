#include "host/apps/daemon/fed_frames.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/joint_senders.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"

namespace octoskin {
namespace {

/// A feeder that has gone: its connection is closed as soon as all that it sent is read.
bool has_gone(int connection) {
    pollfd look{connection, 0, 0};
    return ::poll(&look, 1, 0) > 0 && (look.revents & (POLLHUP | POLLERR)) != 0;
}

std::string program_at(int connection) {
    ucred peer{};
    socklen_t size = sizeof(peer);
    if (::getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return "another program";
    return describe(JointSender{.pid = peer.pid, .uid = peer.uid, .address = {}});
}

std::string seconds_text(std::chrono::milliseconds duration) {
    return fmt::format("{:g} s", std::chrono::duration<double>(duration).count());
}

std::string text_of(const openni2::FrameSize& size) {
    return fmt::format("{} x {}", size.width, size.height);
}

}  // namespace

/// The connection of a feeder whose header is read.
class FedFrames::Stream final : public FrameStream {
  public:
    Stream(FedFrames& source, int interrupt)
        : source_(source),
          frames_(source.begin_feeding(), source.silence_max_, interrupt, socketcan::receive_text) {}
    ~Stream() override { source_.end_feeding(); }

    /// Why it is no stream for this camera, if it is none.
    [[nodiscard]] Status<std::string> begin() {
        const auto header = frames_.read_header();
        if (!header) return unexpected(why(header.error(), "no header of a stream"));
        header_ = *header;
        if (header_.size != source_.size_)
            return unexpected(reason(fmt::format("its feeder sends images of {} pixels, the rig has {}",
                                                 text_of(header_.size), text_of(source_.size_))));
        return Done{};
    }
    [[nodiscard]] double rate_hz() const override { return header_.rate_mhz * 1e-3; }
    [[nodiscard]] openni2::FrameSize size() const override { return header_.size; }
    [[nodiscard]] Result<openni2::PipedFrame, std::string> read() override {
        auto frame = frames_.read_frame(header_.size);
        if (!frame) return unexpected(why(frame.error(), "no whole frame"));
        if (!frame->has_value()) return unexpected(reason("its feeder has ended"));
        openni2::PipedFrame read = std::move(**frame);
        read.is_timed = read.is_timed &&
                        is_timely(read.timestamp_us, static_cast<std::uint64_t>(monotonic_now().ns / 1000));
        return read;
    }
    [[nodiscard]] std::string reason(const std::string& what) override {
        return source_.device_ + ": " + what;
    }

  private:
    [[nodiscard]] std::string why(openni2::PipeError error, const char* missing) {
        switch (error) {
            case openni2::PipeError::timeout:
                return reason(
                    fmt::format("its feeder sent {} for {}", missing, seconds_text(source_.silence_max_)));
            case openni2::PipeError::closed:
                return reason("its feeder is gone");
            case openni2::PipeError::wrong_format:
                return reason(
                    fmt::format("what its feeder sends is no stream of depth frames of at most {} pixels",
                                openni2::kPixelsMax));
            case openni2::PipeError::interrupted:
            case openni2::PipeError::io:
                break;
        }
        return reason(name(error));
    }

    FedFrames& source_;
    openni2::FramePipe frames_;
    openni2::StreamHeader header_;
};

FedFrames::FedFrames(std::string device, openni2::FrameSize size, std::chrono::milliseconds silence_max)
    : device_(std::move(device)), size_(size), silence_max_(silence_max) {}

FedFrames::~FedFrames() {
    if (waiting_ >= 0) socketcan::close_socket(waiting_);
}

/// A feeder that was started again may come before the end of its former connection is read. The mutex is
/// held.
int FedFrames::present() const {
    for (const int connection : {waiting_, feeding_})
        if (connection >= 0 && !has_gone(connection)) return connection;
    return -1;
}

bool FedFrames::take(int connection) {
    int gone = -1;
    {
        const std::lock_guard lock(mutex_);
        if (present() >= 0) return false;
        gone = std::exchange(waiting_, connection);
        given_.wake();
    }
    if (gone >= 0) socketcan::close_socket(gone);
    return true;
}

std::string FedFrames::feeder() {
    const std::lock_guard lock(mutex_);
    const int connection = present();
    return connection < 0 ? std::string() : program_at(connection);
}

Result<std::unique_ptr<FrameStream>, std::string> FedFrames::open(int interrupt) {
    std::array<pollfd, 2> waiting{{{given_.descriptor(), POLLIN, 0}, {interrupt, POLLIN, 0}}};
    while (::poll(waiting.data(), waiting.size(), -1) <= 0) continue;
    if (waiting[1].revents != 0) return unexpected(why_at_first());
    auto stream = std::make_unique<Stream>(*this, interrupt);
    if (auto begun = stream->begin(); !begun) return unexpected(begun.error());
    return std::unique_ptr<FrameStream>(std::move(stream));
}

int FedFrames::begin_feeding() {
    const std::lock_guard lock(mutex_);
    given_.clear();
    feeding_ = std::exchange(waiting_, -1);
    return feeding_;
}

void FedFrames::end_feeding() {
    int ended = -1;
    {
        const std::lock_guard lock(mutex_);
        ended = std::exchange(feeding_, -1);
    }
    if (ended >= 0) socketcan::close_socket(ended);
}

bool FedFrames::is_timely(std::uint64_t timestamp_us, std::uint64_t now_us) noexcept {
    constexpr auto kLate = static_cast<std::uint64_t>(std::chrono::microseconds(kLateMax).count());
    constexpr auto kAhead = static_cast<std::uint64_t>(std::chrono::microseconds(kAheadMax).count());
    return timestamp_us > now_us ? timestamp_us - now_us <= kAhead : now_us - timestamp_us <= kLate;
}

}  // namespace octoskin
