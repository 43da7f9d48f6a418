// A depth image of a data set: read with as many values as its size says, or refused with a reason.
#include <cassert>

#include "host/io/tum/depth_png.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    const auto image = tum::read_depth_png(directory.write("input.png", fuzz::text_of({data, size})));
    if (!image) {
        assert(!image.error().empty());
        return 0;
    }
    assert(image->width > 0 && image->width <= 4096 && image->height > 0 && image->height <= 4096);
    assert(image->values.size() == std::size_t{image->width} * image->height);
    return 0;
}
