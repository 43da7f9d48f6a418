#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

MappingConfig paper_mapping() {
    MappingConfig config;
    config.depth_update = DepthUpdate::paper;
    config.depth_filter.is_enabled = false;
    return config;
}

MappingConfig robust_mapping() {
    MappingConfig config;
    config.depth_update = DepthUpdate::robust;
    config.depth_filter.is_enabled = true;
    return config;
}

MappingConfig fast_mapping() {
    MappingConfig config = robust_mapping();
    config.depth_update = DepthUpdate::fast;
    return config;
}

}  // namespace octoskin
