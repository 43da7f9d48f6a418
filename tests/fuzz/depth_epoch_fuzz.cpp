// The sidecar of a depth recording: read, or refused with a reason; what is read is written back as the same.
#include <cassert>

#include "host/io/openni2/depth_epoch.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    const auto file = directory.write("depth.epoch.yaml", fuzz::text_of({data, size}));
    const auto epoch = openni2::read_epoch(file);
    if (!epoch) {
        assert(!epoch.error().what.empty());
        return 0;
    }
    assert(epoch->first_frame.ns >= 0);
    assert(openni2::write_epoch(file, *epoch));
    const auto again = openni2::read_epoch(file);
    assert(again && again->first_frame == epoch->first_frame && again->frames == epoch->frames);
    return 0;
}
