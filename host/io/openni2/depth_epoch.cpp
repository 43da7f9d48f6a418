#include "host/io/openni2/depth_epoch.hpp"

#include <yaml-cpp/yaml.h>

#include <exception>
#include <fstream>
#include <string>

namespace octoskin::openni2 {
namespace {

constexpr const char* kSchema = "octoskin-depth-epoch/1";

Unexpected<DepthSourceError> failure(const std::filesystem::path& file, const std::string& what) {
    return unexpected(DepthSourceError{file.string() + ": " + what});
}

}  // namespace

Status<DepthSourceError> write_epoch(const std::filesystem::path& file, const DepthEpoch& epoch) {
    std::ofstream out(file);
    out << "# depth.oni counts its time from its first frame; this is when that was, on the host's monotonic "
           "clock.\n"
        << "schema: " << kSchema << '\n'
        << "first_frame_us: " << epoch.first_frame.ns / 1000 << '\n'
        << "frames: " << epoch.frames << '\n';
    out.close();
    if (!out) return failure(file, "cannot write; is the disk full?");
    return Done{};
}

Result<DepthEpoch, DepthSourceError> read_epoch(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        return failure(file, "no such file; without it the depth frames have no time");
    }
    try {
        const YAML::Node root = YAML::LoadFile(file.string());
        if (!root.IsMap() || root["schema"].as<std::string>("") != kSchema) {
            return failure(file, std::string("expected 'schema: ") + kSchema + "'");
        }
        for (const auto& entry : root) {
            const auto key = entry.first.as<std::string>();
            if (key != "schema" && key != "first_frame_us" && key != "frames") {
                return failure(file, "line " + std::to_string(entry.first.Mark().line + 1) +
                                         ": unknown key '" + key + "'");
            }
        }
        constexpr std::int64_t kMaxUs = std::int64_t{1} << 48U;  // what FOLLOW_UP can say
        const auto first_us = root["first_frame_us"].as<std::int64_t>();
        if (first_us < 0 || first_us > kMaxUs)
            return failure(file, "first_frame_us: expected 0 to 2^48, microseconds");
        return DepthEpoch{HostTime{first_us * 1000}, root["frames"].as<std::uint64_t>()};
    } catch (const std::exception& broken) {  // yaml-cpp's own, and the stream's
        return failure(file, broken.what());
    }
}

}  // namespace octoskin::openni2
