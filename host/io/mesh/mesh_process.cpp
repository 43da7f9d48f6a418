#include "host/io/mesh/mesh_process.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "host/io/mesh/mesh_bytes.hpp"
#include "host/io/openni2/helper_process.hpp"

namespace octoskin {
namespace {

using openni2::HelperProcess;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{90};  ///< the helper's own limit of processor time is 60 s
constexpr std::chrono::milliseconds kEndPatience{2'000};
constexpr std::size_t kResultMax = 256U << 20U;

/// All that comes from the pipe until its end; short if that takes too long or is too much.
std::string read_all(int descriptor) {
    std::string bytes;
    std::string part(1U << 20U, '\0');
    const auto until = Clock::now() + kPatience;
    while (bytes.size() <= kResultMax) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
        if (left.count() <= 0) return {};
        pollfd ready{descriptor, POLLIN, 0};
        if (::poll(&ready, 1, static_cast<int>(left.count())) < 0 && errno == EINTR) continue;
        const ssize_t count = ::read(descriptor, part.data(), part.size());
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (count <= 0) return bytes;
        bytes.append(part, 0, static_cast<std::size_t>(count));
    }
    return {};
}

}  // namespace

Result<TriangleMesh, Error> read_mesh_in_process(const MeshCopy& mesh,
                                                 const std::optional<std::filesystem::path>& helper) {
    const auto failed = [&mesh](Error error) {
        return unexpected(in_file(std::move(error), mesh.bytes.shown()));
    };
    const auto program = openni2::find_helper(kMeshReader, helper);
    if (!program) return failed({ErrorCode::no_program, program.error()});
    auto process = HelperProcess::start(*program, {mesh.name}, openni2::HelperPipe::its_output,
                                        openni2::HelperComplaints::kept, mesh.bytes.descriptor());
    if (!process) return failed({ErrorCode::no_program, process.error()});
    const std::string bytes = read_all(process->descriptor());
    const auto end = process->wait(kEndPatience);
    const std::string complaint = process->complaint();
    auto triangles = end ? std::nullopt : mesh_of(bytes);
    if (triangles) return *std::move(triangles);
    constexpr const char* kTooLong = "it takes more than a minute to read";
    if (end && end->find("processor time") != std::string::npos)
        return failed({ErrorCode::time_limit, kTooLong, "", "export it with fewer parts"});
    const std::string reason =
        complaint.empty() ? std::string(kMeshReader) + ": " + end.value_or("no mesh") : complaint;
    return failed({ErrorCode::foreign_format, "not a mesh that can be read: " + reason, "",
                   "export it anew as binary STL"});
}

}  // namespace octoskin
