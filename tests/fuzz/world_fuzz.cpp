// A world and a mesh that it names, through the process that reads them: solids, or a reason, within its
// limits. The input is the SDF, or the mesh of a world that is a mesh alone if it does not begin with "<".
#include <cassert>
#include <cmath>

#include "hw/sim/world/sdf_solids.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

namespace {

constexpr const char* kMeshWorld =
    "<sdf version='1.9'><model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>mesh.stl</uri>"
    "</mesh></geometry></visual></link></model></sdf>";

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    const std::string_view text = fuzz::text_of({data, size});
    const bool is_world = text.starts_with("<");
    directory.write("mesh.stl", is_world ? "" : text);
    const auto file = directory.write("world.sdf", is_world ? text : kMeshWorld);
    constexpr sim::ReadLimits kLimits{
        .memory_mib = 512, .processor_s = 2, .patience = std::chrono::seconds(20), .result_mib = 16};
    const auto solids = sim::read_solids(file, kLimits);
    if (!solids) {
        assert(!solids.error().what.empty());
        return 0;
    }
    assert(!solids->solids.empty());
    return 0;
}
