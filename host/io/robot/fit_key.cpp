#include "host/io/robot/fit_key.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <set>
#include <string_view>
#include <utility>

#include "host/io/mesh/mesh_process.hpp"
#include "host/io/robot/robot_fit.hpp"
#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin {
namespace {

/// Raise it with each change of the fit or of the URDF that is written.
constexpr std::string_view kFitVersion = "octoskin fit 1";

/// Fowler, Noll, Vo 1991, from two starts.
class Hash {
  public:
    void add(std::string_view bytes) {
        add_number(bytes.size());
        for (const char c : bytes) add_byte(static_cast<unsigned char>(c));
    }
    [[nodiscard]] std::string text() const { return fmt::format("{:016x}{:016x}", first_, second_); }

  private:
    void add_number(std::uint64_t number) {
        for (int i = 0; i < 8; ++i) add_byte(static_cast<unsigned char>(number >> (8 * i)));
    }
    void add_byte(unsigned char byte) {
        constexpr std::uint64_t kPrime = 0x0000'0100'0000'01B3U;
        first_ = (first_ ^ byte) * kPrime;
        second_ = (second_ ^ byte ^ (second_ >> 32U)) * kPrime;
    }

    std::uint64_t first_ = 0xCBF2'9CE4'8422'2325U;
    std::uint64_t second_ = 0x8422'2325'CBF2'9CE4U;
};

}  // namespace

Result<std::string, Error> fit_key(const FilePlace& urdf, const rig::RobotShapes& shapes,
                                   const MeshSearch& search) {
    const auto text = rig::read_urdf_text(urdf);
    if (!text) return unexpected(text.error());
    Hash hash;
    hash.add(kFitVersion);
    hash.add(*text);
    hash.add(shapes.base_link);
    const MeshPlaces places(urdf.shown(), search);
    std::set<std::string> seen;
    std::vector<rig::ElementFault> faults;
    for (const rig::ShapedLink& link : shapes.links) {
        for (const rig::LinkShape& shape : body_shapes(link)) {
            if (shape.kind != rig::ShapeKind::mesh || !seen.insert(shape.mesh).second) continue;
            const auto failed = [&](Error error) {
                error.file = urdf.shown();
                error.line = shape.line;
                error.key = "link " + link.name;
                faults.push_back({std::move(error), shape.mesh});
            };
            const auto place = places.find(shape.mesh);
            if (!place) {
                failed(place.error());
                continue;
            }
            const auto opened = place->open();
            const auto bytes = opened ? opened->read(kMeshBytesMax) : unexpected(opened.error());
            if (bytes) {
                hash.add(*bytes);
            } else {
                failed(to_error(bytes.error(), place->shown().string() + ": cannot be read: "));
            }
        }
    }
    if (!faults.empty()) return unexpected(rig::one_error_of(std::move(faults)));
    return hash.text();
}

}  // namespace octoskin
