#include "hw/sim/world/sdf/sdf_module.hpp"

#include "hw/sim/world/sdf/sdf_reader.hpp"

using octoskin::sim::SdfInput;
using octoskin::sim::SolidsOrError;

extern "C" [[gnu::visibility("default")]] void octoskin_read_solids_v5(const SdfInput& sdf,
                                                                       SolidsOrError* result);

void octoskin_read_solids_v5(const SdfInput& sdf, SolidsOrError* result) {
    *result = octoskin::sim::parse_solids(sdf);
}
