// One shape, a lopsided wedge, as files of each format. The corners are in metres.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>

namespace octoskin::testing_support {

inline const std::array<Eigen::Vector3d, 4> kWedge{
    Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.25, 0.0, 0.0), Eigen::Vector3d(0.0, 0.5, 0.0),
    Eigen::Vector3d(0.0, 0.125, 1.0)};
inline constexpr std::array<std::array<int, 3>, 4> kWedgeFaces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};

/// 80 bytes of head, the count, and for each triangle a normal, three corners and two bytes (floats).
inline std::string wedge_stl() {
    std::string bytes(80, ' ');
    const auto add = [&bytes](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    add(static_cast<std::uint32_t>(kWedgeFaces.size()));
    for (const auto& face : kWedgeFaces) {
        for (int i = 0; i < 3; ++i) add(0.0F);
        for (const int corner : face)
            for (int axis = 0; axis < 3; ++axis)
                add(static_cast<float>(kWedge[static_cast<std::size_t>(corner)][axis]));
        add(std::uint16_t{0});
    }
    return bytes;
}

inline std::string wedge_ascii_stl() {
    std::string text = "solid wedge\n";
    for (const auto& face : kWedgeFaces) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int corner : face) {
            const auto& at = kWedge[static_cast<std::size_t>(corner)];
            text += fmt::format("vertex {} {} {}\n", at.x(), at.y(), at.z());
        }
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid wedge\n";
}

inline std::string wedge_obj() {
    std::string text = "mtllib missing.mtl\n";
    for (const auto& at : kWedge) text += fmt::format("v {} {} {}\n", at.x(), at.y(), at.z());
    for (const auto& face : kWedgeFaces)
        text += fmt::format("f {} {} {}\n", face[0] + 1, face[1] + 1, face[2] + 1);
    return text;
}

/// `unit_m`: the file's unit; `node`: a transform of the node that holds the mesh, as COLLADA writes it.
inline std::string wedge_dae(const std::string& up_axis, double unit_m, const std::string& node = {}) {
    std::string corners;
    for (const auto& at : kWedge)
        corners += fmt::format("{} {} {} ", at.x() / unit_m, at.y() / unit_m, at.z() / unit_m);
    std::string faces;
    for (const auto& face : kWedgeFaces) faces += fmt::format("{} {} {} ", face[0], face[1], face[2]);
    return fmt::format(R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><created>2026-01-01T00:00:00</created><modified>2026-01-01T00:00:00</modified>
    <unit name="unit" meter="{}"/><up_axis>{}</up_axis></asset>
  <library_geometries><geometry id="wedge"><mesh>
    <source id="corners"><float_array id="numbers" count="12">{}</float_array>
      <technique_common><accessor source="#numbers" count="4" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="vertices"><input semantic="POSITION" source="#corners"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#vertices" offset="0"/><p>{}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene">
    <node id="outer">{}<node id="inner"><instance_geometry url="#wedge"/></node></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
)",
                       unit_m, up_axis, corners, faces, node);
}

}  // namespace octoskin::testing_support
