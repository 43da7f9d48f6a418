#include "tests/system/daemon/daemon_fixture.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>

#include "host/io/openni2/oni_writer.hpp"
#include "tests/support/experiment_log/experiment_log.hpp"

namespace octoskin::test {
namespace {

namespace fs = std::filesystem;

/// Of this program, in which the simulation is, and of the files that it reads.
std::string age_of_origins(const fs::path& program) {
    auto newest = fs::last_write_time(program);
    for (const auto& entry : fs::recursive_directory_iterator(OCTOSKIN_SOURCE_DIR "/hw"))
        if (entry.is_regular_file()) newest = std::max(newest, entry.last_write_time());
    return fmt::format("{:x}", newest.time_since_epoch().count());
}

std::vector<StampedFrame> read_log(const fs::path& file) {
    static_assert(std::is_trivially_copyable_v<StampedFrame>);
    std::error_code is_absent;
    const auto bytes = fs::file_size(file, is_absent);
    if (is_absent) return {};
    std::vector<StampedFrame> log(bytes / sizeof(StampedFrame));
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(log.data()), static_cast<std::streamsize>(bytes));
    EXPECT_TRUE(stream && bytes % sizeof(StampedFrame) == 0) << file;
    return log;
}

/// Under its name once it is whole.
void write_log(const fs::path& file, const std::vector<StampedFrame>& log) {
    const fs::path own = file.string() + "." + std::to_string(::getpid());
    std::ofstream(own, std::ios::binary)
        .write(reinterpret_cast<const char*>(log.data()),
               static_cast<std::streamsize>(log.size() * sizeof(StampedFrame)));
    fs::rename(own, file);
}

/// Each case is a process of its own, and most need this log: it is simulated once for each build.
std::vector<StampedFrame> kept_log() {
    const fs::path program = fs::read_symlink("/proc/self/exe");
    const fs::path kept = program.string() + "_log_" + age_of_origins(program);
    std::vector<StampedFrame> log = read_log(kept);
    if (!log.empty()) return log;
    log = make_log(rig::read_rig(kExperiment).value());
    write_log(kept, log);
    return log;
}

}  // namespace

std::vector<StampedFrame> make_log(rig::Rig rig, std::uint32_t revolutions) {
    return experiment_log(std::move(rig), 3, revolutions);
}

const std::vector<StampedFrame>& log_of_experiment() {
    static const std::vector<StampedFrame> log = kept_log();
    return log;
}

std::filesystem::path record_wall(const testing_support::ScratchFolder& folder, std::size_t columns) {
    constexpr openni2::FrameSize kSize{512, 424};
    const auto file = folder / "being-made.oni";
    auto writer = openni2::OniWriter::create(file, folder / "wall.epoch.yaml", kSize);
    EXPECT_TRUE(writer) << writer.error().what;
    std::vector<std::uint16_t> depth_mm(kSize.pixels(), 0);
    for (std::size_t i = 0; i < depth_mm.size(); ++i)
        if (i % kSize.width < columns) depth_mm[i] = 3'000;
    for (int i = 0; i < 20; ++i)
        EXPECT_TRUE(writer->write(HostTime{1'000'000'000LL + 100'000'000LL * i}, depth_mm));
    EXPECT_TRUE(writer->close());
    std::filesystem::rename(file, folder / "wall.oni");  // whole, for whoever looks for it
    return folder / "wall.oni";
}

SilentBus::SilentBus() {
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends_.data()), 0);
}
SilentBus::~SilentBus() {
    ::close(ends_[1]);
}

DaemonTest::DaemonTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    const int room = 1 << 20;
    for (const int end : ends) ::setsockopt(end, SOL_SOCKET, SO_SNDBUF, &room, sizeof(room));
    its_end_ = ends[0];
    our_end_ = ends[1];
}

void DaemonTest::start(const std::vector<std::string>& more_arguments, const std::filesystem::path& rig,
                       const std::vector<StampedFrame>& log) {
    daemon_.emplace(folder_, its_end_, more_arguments, rig);
    bus_.emplace(our_end_, log);
}

DaemonTest::Pause DaemonTest::hold_up(std::chrono::milliseconds duration) const {
    Pause pause;
    pause.before = daemon_->status();
    daemon_->signal(SIGSTOP);
    std::this_thread::sleep_for(duration);
    daemon_->signal(SIGCONT);
    pause.after = daemon_->status();
    return pause;
}

bool DaemonTest::has_problem(const nlohmann::json& status, const std::string& text) {
    for (const auto& problem : status["problems"])
        if (problem["code"] == text || problem["text"].get<std::string>().find(text) != std::string::npos)
            return true;
    return false;
}

}  // namespace octoskin::test
