// octoskin-mesh-read NAME: reads the mesh file that is open as descriptor 3 and writes its triangles to
// standard output (mesh_bytes.hpp). NAME tells the format by its ending.
#include <unistd.h>

#include <cstdio>
#include <string>
#include <string_view>

#include "host/core/text/printable.hpp"
#include "host/io/folder/open_file.hpp"
#include "host/io/helper_limits/confinement.hpp"
#include "host/io/helper_limits/helper_limits.hpp"
#include "host/io/mesh/mesh_bytes.hpp"
#include "host/io/mesh/mesh_process.hpp"
#include "host/io/openni2/helper_process.hpp"
#include "hw/mesh/mesh_file.hpp"

namespace octoskin {
namespace {

constexpr std::uint64_t kProcessorSeconds = 60;

/// The open file alone, under its name.
class OneFile final : public AllowedFiles {
  public:
    explicit OneFile(std::filesystem::path name) : name_(std::move(name)) {}

    [[nodiscard]] Result<std::filesystem::path, std::string> openable(
        const std::filesystem::path& file) const override {
        if (file != name_) return unexpected(std::string("is not read"));
        return path_of_descriptor(openni2::HelperProcess::kInherited);
    }

  private:
    std::filesystem::path name_;
};

bool write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

int read(const std::string& name, int output) {
    const OneFile file(name);
    const auto mesh = read_mesh(name, &file);
    if (!mesh) {
        std::fprintf(stderr, "%s\n", printable(mesh.error()).c_str());
        return 1;
    }
    if (mesh->vertices.size() > kMeshVerticesMax || mesh->triangles.size() > kMeshTrianglesMax) {
        std::fprintf(stderr, "expected at most %zu triangles, found %zu\n", kMeshTrianglesMax,
                     mesh->triangles.size());
        return 1;
    }
    return write_all(output, to_bytes(*mesh)) ? 0 : 1;
}

}  // namespace
}  // namespace octoskin

int main(int argc, char** argv) {
    using namespace octoskin;
    if (argc != 2) {
        std::fputs(
            "usage: octoskin-mesh-read NAME 3< FILE > triangles\nA helper of octoskin; `octoskin robot` runs "
            "it.\n",
            stderr);
        return 2;
    }
    limit_this_process(
        {.memory_mib = openni2::kHelperMemoryMib, .exit_without_memory = openni2::kOutOfMemory});
    limit_processor_seconds(kProcessorSeconds);
    limit_file_size(0);
    const int output = take_standard_output();
    (void)confine_this_process("octoskin-mesh-read", NewThreads::refused);
    ::_exit(read(argv[1], output));
}
