// The ELF reader and the checks before flashing: what they find fit lies in flash, and is merged as it is.
#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "hw/image/build_attributes.hpp"
#include "hw/image/flash_contents.hpp"
#include "hw/image/image_check.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin::image {
namespace {

const rig::BoardHardware& board() {
    static const auto kBoard =
        rig::read_board_hardware(OCTOSKIN_SOURCE_DIR "/hw/boards/nucleo_g474re.hardware.yaml");
    if (!kBoard) throw std::runtime_error(kBoard.error().message());
    return *kBoard;
}

void check(std::span<const std::uint8_t> file) {
    const auto image = ElfImage::parse(file);
    if (!image || !faults_of(*image, board()).empty()) return;
    const auto bytes = binary(*image, board());
    assert(board().flash.address + bytes.size() <= board().configuration_page.address);
    for (const ElfSegment& segment : image->segments()) {
        const auto offset = static_cast<std::ptrdiff_t>(segment.physical_address - board().flash.address);
        assert(std::equal(segment.bytes.begin(), segment.bytes.end(), bytes.begin() + offset));
    }
}

}  // namespace
}  // namespace octoskin::image

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    octoskin::image::check({data, size});
    // The attributes alone, too: within a file, few inputs reach them.
    (void)octoskin::image::build_attributes({data, size});
    return 0;
}
