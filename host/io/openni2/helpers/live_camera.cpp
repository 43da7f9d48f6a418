// octoskin-camera --list: lists the cameras (camera_list.hpp).
// octoskin-camera URI [MODE]: writes the depth frames of a camera to standard output (frame_pipe.hpp), each
// with its capture time on the host's monotonic clock. An .oni file as URI is a camera, too; octoskin-film
// then replaces this program and plays it.
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

#include "host/core/text/printable.hpp"
#include "host/io/openni2/capture_clock.hpp"
#include "host/io/openni2/helper_process.hpp"
#include "host/io/openni2/helpers/camera_list.hpp"
#include "host/io/openni2/helpers/depth_stream.hpp"
#include "host/io/openni2/helpers/frame_stream.hpp"

namespace octoskin::openni2 {
namespace {

constexpr const char* kProgram = "octoskin-camera";

int watch(DepthStream& depth, const char* uri, const std::optional<CameraMode>& mode, int descriptor) {
    if (!depth.open(uri)) return depth.complain("cannot open the camera");
    if (!depth.start(mode)) return 1;
    CaptureClock clock;
    return stream_frames(
        depth, descriptor, [&](std::int64_t arrived_us) -> Result<std::int64_t, std::string> {
            const auto stamp_us = static_cast<std::int64_t>(depth.frame().getTimestamp());
            if (const auto captured_us = clock.captured_us(stamp_us, arrived_us)) return *captured_us;
            return unexpected(
                std::string(clock.is_lost() ? "its frames arrived over 0.5 s late for 5 s" : ""));
        });
}

/// Returns only if octoskin-film cannot be started.
int become_film_player(const std::filesystem::path& film) {
    const auto player = find_helper("octoskin-film");
    if (player) ::execl(player->c_str(), player->c_str(), film.c_str(), nullptr);
    const std::string why = player ? player->string() + ": " + std::strerror(errno) : player.error();
    std::fprintf(stderr, "%s: %s\n", kProgram, printable(why).c_str());
    return 1;
}

int list_cameras(int descriptor) {
    const std::string text = camera_list();
    return ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1;
}

}  // namespace
}  // namespace octoskin::openni2

int main(int argc, char** argv) {
    using namespace octoskin::openni2;
    const auto mode = argc == 3 ? parse_camera_mode(argv[2]) : std::nullopt;
    if (argc < 2 || argc > 3 || (argc == 3 && !mode)) {
        std::fputs(
            "usage: octoskin-camera URI|FILE.oni|'' [WIDTHxHEIGHT@HZ] > frames\n       octoskin-camera "
            "--list\nA helper of "
            "octoskin; `octoskin run` runs "
            "it.\n",
            stderr);
        return 2;
    }
    std::error_code error;  // a name that cannot be examined is not a file but a camera's URI
    const std::string uri = argv[1];
    if (std::filesystem::is_regular_file(uri, error))
        return become_film_player(std::filesystem::absolute(uri));
    if (std::filesystem::exists(uri, error)) {
        std::fprintf(stderr, "%s: is not a regular file\n", kProgram);
        return 1;
    }
    const auto output = begin_helper(kProgram);
    if (!output) return 1;
    if (uri == "--list") end_helper(list_cameras(*output));
    DepthStream depth(kProgram);
    end_helper(watch(depth, uri.empty() ? openni::ANY_DEVICE : uri.c_str(), mode, *output));
}
