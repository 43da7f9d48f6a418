#include "tests/ros/raw_type.hpp"

#include <cstring>

namespace octoskin::ros {

RawType::RawType(const Codec& codec) {
    setName(codec.dds_name.c_str());
    // How much Fast DDS allocates at first; endpoints.cpp lets it allocate more.
    m_typeSize = 1024;
    // A ROS 2 node sends none of them, either.
    auto_fill_type_object(false);
    auto_fill_type_information(false);
}

bool RawType::serialize(void* sample, Payload* payload) {
    const auto& bytes = *static_cast<const Bytes*>(sample);
    if (bytes.size() > payload->max_size) {
        return false;
    }
    if (!bytes.empty()) {
        std::memcpy(payload->data, bytes.data(), bytes.size());
    }
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
}

bool RawType::deserialize(Payload* payload, void* sample) {
    static_cast<Bytes*>(sample)->assign(payload->data, payload->data + payload->length);
    return true;
}

std::function<std::uint32_t()> RawType::getSerializedSizeProvider(void* sample) {
    return [sample] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(sample)->size()); };
}

}  // namespace octoskin::ros
