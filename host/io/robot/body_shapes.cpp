#include "host/io/robot/body_shapes.hpp"

#include <algorithm>

namespace octoskin {

const char* name_of(BodySource source) noexcept {
    switch (source) {
        case BodySource::nothing:
            return "nothing";
        case BodySource::collision:
            return "collision";
        case BodySource::visual:
            return "visual";
    }
    return "nothing";
}

BodySource source_of(const rig::ShapedLink& link) {
    if (std::ranges::any_of(link.collisions, rig::is_body)) return BodySource::collision;
    if (rig::is_body_visual(link) && std::ranges::any_of(link.visuals, rig::is_body))
        return BodySource::visual;
    return BodySource::nothing;
}

const std::vector<rig::LinkShape>& body_shapes(const rig::ShapedLink& link) {
    return source_of(link) == BodySource::visual ? link.visuals : link.collisions;
}

bool is_fitted(const rig::LinkShape& shape) noexcept {
    return rig::is_body(shape) && (shape.kind == rig::ShapeKind::mesh || shape.kind == rig::ShapeKind::box);
}

}  // namespace octoskin
