// The outline of an .oni file: whatever the bytes, it ends, and tells of no more than the file has room for;
// what is salvaged of it has an end; and what is checked has a fault within the file, or an end.
#include <algorithm>
#include <cassert>

#include "host/io/openni2/helpers/oni_check.hpp"
#include "host/io/openni2/helpers/oni_outline.hpp"
#include "host/io/openni2/helpers/oni_salvage.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    constexpr std::size_t kRecordHeader = 28;
    static const fuzz::InputDirectory directory;
    const auto file = directory.write("input.oni", fuzz::text_of({data, size}));
    const auto outline = openni2::outline_of(file);
    assert(outline.frames <= size / kRecordHeader);
    assert(!outline.length || *outline.length <= size);
    const auto fault = openni2::fault_of(file);
    assert(fault ? fault->position <= std::max<std::size_t>(size, 24) : outline.length.has_value());
    // A file that had its end has the same outline up to there, whatever follows.
    if (outline.length) {
        std::filesystem::resize_file(file, *outline.length);
        const auto cut = openni2::outline_of(file);
        assert(cut.frames == outline.frames && cut.length == outline.length);
    }
    const auto copy = file.parent_path() / "copy.oni";
    if (const auto frames = openni2::salvage(file, copy)) {
        const auto salvaged = openni2::outline_of(copy);
        assert(*frames > 0 && salvaged.frames == *frames);
        assert(salvaged.length == std::filesystem::file_size(copy));
    }
    return 0;
}
