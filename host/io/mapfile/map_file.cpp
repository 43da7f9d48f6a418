#include "host/io/mapfile/map_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <system_error>

#include "host/io/mapfile/atomic_file.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/mapfile/ply_writer.hpp"

namespace octoskin {
namespace {

constexpr float kLogOddsMax = 100.0F;       // a mapping file may say no more
constexpr std::uint64_t kBytesPerNode = 5;  ///< of an .ot file: log-odds, and which children there are

/// A brick of 512 known voxels takes 2112 bytes of memory, and 585 nodes of a file; one that is alone 13 more
/// above it. Half as much again as the memory has room for both, the mebibyte for the header of a small one.
std::uint64_t file_bytes_max_of(const MapConfig& config) {
    return (std::uint64_t{config.memory_max_mib} << 20U) * 3 / 2 + (std::uint64_t{1} << 20U);
}

Unexpected<MapFileError> fail(const std::filesystem::path& file, const std::string& what,
                              bool is_too_large = false) {
    return unexpected(MapFileError{fmt::format("{}: {}", file.string(), what), is_too_large});
}

Unexpected<MapFileError> fail_with_errno(const std::filesystem::path& file, const char* step) {
    return fail(file, fmt::format("{} failed ({})", step, std::generic_category().message(errno)));
}

/// Closes on every way out.
class Descriptor {
  public:
    explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    [[nodiscard]] int get() const noexcept { return descriptor_; }

  private:
    int descriptor_;
};

/// Without blocking on a pipe or a device that someone put in the file's place.
Result<std::string, MapFileError> read_bytes(const std::filesystem::path& file, std::uint64_t bytes_max) {
    const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (descriptor.get() < 0) return fail_with_errno(file, "opening");
    struct stat status {};
    if (::fstat(descriptor.get(), &status) != 0) return fail_with_errno(file, "looking at it");
    if (!S_ISREG(status.st_mode)) return fail(file, "not a regular file");
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > bytes_max) {
        return fail(file, fmt::format("{} bytes, the limit is {}", size, bytes_max), true);
    }
    std::string bytes(size, '\0');
    std::size_t position = 0;
    while (position < bytes.size()) {
        const ssize_t count = ::read(descriptor.get(), bytes.data() + position, bytes.size() - position);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return fail_with_errno(file, "reading");
        if (count == 0) return fail(file, "became shorter while it was read");
        position += static_cast<std::size_t>(count);
    }
    return bytes;
}

}  // namespace

Status<MapFileError> save_map(const FusedMap& map, const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    ByteSource content;
    if (extension == ".ot") {
        content = [&map](const ByteSink& sink) { write_ot(map, sink); };
    } else if (extension == ".bt") {
        content = [&map](const ByteSink& sink) { write_bt(map, sink); };
    } else if (extension == ".ply") {
        content = [&map](const ByteSink& sink) { (void)sink(encode_ply(map)); };
    } else {
        return fail(file, fmt::format("extension \"{}\" is not one of .ot, .bt, .ply", extension));
    }
    const auto saved = save_atomically(file, content);
    if (!saved) return unexpected(MapFileError{saved.error().message(), false});
    return Done{};
}

std::string describe_other_voxels(const std::filesystem::path& file, double map_m, double mapping_m) {
    return file.string() + ": its voxels are " + std::to_string(map_m) + " m, the mapping's are " +
           std::to_string(mapping_m) + " m";
}

Result<FusedMap, MapFileError> load_map(const std::filesystem::path& file, const MapReadLimits& limits,
                                        std::uint64_t file_bytes_max) {
    const auto bytes = read_bytes(file, file_bytes_max);
    if (!bytes) return unexpected(bytes.error());
    auto map = decode_octomap(*bytes, limits);
    if (!map) {
        const MapFault fault = map.error().fault;
        return fail(file, map.error().what, fault == MapFault::no_room || fault == MapFault::too_many_nodes);
    }
    return std::move(map).value();
}

Result<FusedMap, MapFileError> load_map_of(const MapConfig& config, const std::filesystem::path& file) try {
    const std::uint64_t bytes_max = file_bytes_max_of(config);
    MapConfig any_clamps = config;
    any_clamps.log_odds_min = -kLogOddsMax;
    any_clamps.log_odds_max = kLogOddsMax;
    auto map = load_map(file, {.map = any_clamps, .nodes_max = bytes_max / kBytesPerNode}, bytes_max);
    if (!map && map.error().is_too_large) {
        return fail(file,
                    fmt::format("it was saved with more memory than the {} MiB of map.memory_max_mib: raise "
                                "that in the mapping file ({})",
                                config.memory_max_mib, map.error().message),
                    true);
    }
    if (!map) return map;
    if (map->resolution_m() != config.resolution_m) {
        return unexpected(
            MapFileError{.message = describe_other_voxels(file, map->resolution_m(), config.resolution_m),
                         .is_of_other_voxels = true});
    }
    map->limit(config);
    return map;
} catch (const std::bad_alloc&) {
    return fail(file, "there is no memory to read it");
}

}  // namespace octoskin
