#include <string>

#include "common/wire/crc.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

std::uint32_t rig_hash(const Rig& rig) {
    const std::string text = canonical_text(rig, "robot.urdf");
    return crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace octoskin::rig
