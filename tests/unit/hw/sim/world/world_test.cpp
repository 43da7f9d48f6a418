// Rays, surfaces and interiors of simple solids. Oracle: the shapes' own equations, solved by hand.
#include "hw/sim/world/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "hw/sim/world/shapes.hpp"

namespace octoskin::sim {
namespace {

constexpr double kFar_m = 100.0;

Solid solid_of(const TriangleMesh& mesh, const Eigen::Vector3d& p_world_solid = Eigen::Vector3d::Zero()) {
    const auto placed = weld(transformed(mesh, Eigen::Isometry3d(Eigen::Translation3d(p_world_solid))));
    return {"model/link/visual", "model", placed.vertices, placed.triangles, is_closed(placed)};
}

World world_of(const TriangleMesh& mesh) {
    return World(std::vector<Solid>{solid_of(mesh)});
}

TEST(WorldCast, meets_a_box_on_each_of_its_six_sides) {
    const World world = world_of(box_mesh({1.0, 2.0, 3.0}));
    const Eigen::Vector3d half(0.5, 1.0, 1.5);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            const Eigen::Vector3d out = side * Eigen::Vector3d::Unit(axis);
            const auto hit = world.cast(5.0 * out + Eigen::Vector3d(0.1, 0.1, 0.1), -out, kFar_m);
            ASSERT_TRUE(hit);
            EXPECT_NEAR(hit->range_m, 5.0 + side * 0.1 - half[axis], 1e-12);
            EXPECT_NEAR((hit->normal - out).norm(), 0.0, 1e-12);
        }
    }
}

TEST(WorldCast, ends_at_the_range_limit) {
    const World world = world_of(box_mesh({1.0, 1.0, 1.0}));
    EXPECT_TRUE(world.cast({-2.0, 0.1, 0.2}, Eigen::Vector3d::UnitX(), 1.501));
    EXPECT_FALSE(world.cast({-2.0, 0.1, 0.2}, Eigen::Vector3d::UnitX(), 1.499));
    EXPECT_FALSE(world.cast({-2.0, 0.1, 0.2}, -Eigen::Vector3d::UnitX(), kFar_m));
}

TEST(WorldCast, sees_the_nearest_of_several_solids_and_names_it) {
    const World world(std::vector<Solid>{solid_of(box_mesh({0.2, 0.2, 0.2}), {3.0, 0.0, 0.0}),
                                         solid_of(box_mesh({0.2, 0.2, 0.2}), {2.0, 0.0, 0.0})});
    const auto hit = world.cast({0.0, 0.03, 0.02}, Eigen::Vector3d::UnitX(), kFar_m);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->solid, 1u);
    EXPECT_NEAR(hit->range_m, 1.9, 1e-12);
}

TEST(WorldCast, agrees_with_the_sphere_equation_to_the_facets_sagitta) {
    const World world = world_of(ellipsoid_mesh({0.5, 0.5, 0.5}));
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> offset(-0.3, 0.3);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3d origin(-3.0, offset(random), offset(random));
        const auto hit = world.cast(origin, Eigen::Vector3d::UnitX(), kFar_m);
        ASSERT_TRUE(hit);
        const double expected = 3.0 - std::sqrt(0.25 - origin.y() * origin.y() - origin.z() * origin.z());
        // Two facets' sagittas (0.27 mm along the meridian at 48 steps), seen at up to 58 degrees.
        EXPECT_NEAR(hit->range_m, expected, 1.5e-3);
        EXPECT_GE(hit->range_m, expected - 1e-9) << "an inscribed mesh lies inside the sphere";
    }
}

TEST(WorldCast, meets_cylinder_capsule_and_ellipsoid_where_their_axes_end) {
    const World cylinder = world_of(cylinder_mesh(0.2, 1.0));
    EXPECT_NEAR(cylinder.cast({0.05, 0.02, 5.0}, -Eigen::Vector3d::UnitZ(), kFar_m)->range_m, 4.5, 1e-12);
    EXPECT_NEAR(cylinder.cast({5.0, 0.0, 0.1}, -Eigen::Vector3d::UnitX(), kFar_m)->range_m, 4.8, 1e-6);
    const World capsule = world_of(capsule_mesh(0.2, 1.0));
    EXPECT_NEAR(capsule.cast({1e-4, 1e-5, 5.0}, -Eigen::Vector3d::UnitZ(), kFar_m)->range_m, 4.3, 1e-4);
    EXPECT_NEAR(capsule.cast({5.0, 0.0, 0.3}, -Eigen::Vector3d::UnitX(), kFar_m)->range_m, 4.8, 1e-6);
    const World ellipsoid = world_of(ellipsoid_mesh({0.1, 0.2, 0.3}));
    EXPECT_NEAR(ellipsoid.cast({5.0, 0.0, 0.0}, -Eigen::Vector3d::UnitX(), kFar_m)->range_m, 4.9, 1e-6);
    EXPECT_NEAR(ellipsoid.cast({0.0, 5.0, 0.0}, -Eigen::Vector3d::UnitY(), kFar_m)->range_m, 4.8, 1e-6);
}

TEST(WorldCast, leaves_no_gap_at_the_edges_between_triangles) {
    // Rays straight at the diagonals and edges of a tessellated sphere's front: every one must hit.
    const auto mesh = ellipsoid_mesh({0.5, 0.5, 0.5});
    const World world = world_of(mesh);
    const Eigen::Vector3d eye(3.0, 0.4, 0.3);
    for (const auto& triangle : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const Eigen::Vector3d middle =
                0.5 * (mesh.vertices[static_cast<std::size_t>(triangle[i])] +
                       mesh.vertices[static_cast<std::size_t>(triangle[(i + 1) % 3])]);
            if (middle.dot(eye - middle) > 0.1) {  // away from the silhouette
                const auto hit = world.cast(eye, (middle - eye).normalized(), kFar_m);
                ASSERT_TRUE(hit);
                EXPECT_NEAR(hit->range_m, (middle - eye).norm(), 1e-4);
            }
        }
    }
}

TEST(WorldCast, gives_an_images_rays_what_it_gives_each_alone) {
    const World world(std::vector<Solid>{solid_of(ellipsoid_mesh({0.5, 0.5, 0.5}), {3.0, 0.0, 0.0}),
                                         solid_of(box_mesh({0.1, 4.0, 4.0}), {4.0, 0.0, 0.0})});
    std::vector<Eigen::Vector3d> directions;
    for (int i = 0; i < 1003; ++i) {  // not a multiple of the packet
        directions.emplace_back(1.0, -0.7 + 0.0014 * i, 0.1);
    }
    std::vector<double> t(directions.size());
    world.cast_fan({0.0, 0.0, 0.0}, directions, 10.0, t);
    int hits = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
        const auto hit = world.cast({0.0, 0.0, 0.0}, directions[i].normalized(), 20.0);
        ASSERT_EQ(hit.has_value(), std::isfinite(t[i]));
        if (hit) {
            ++hits;
            EXPECT_NEAR(t[i] * directions[i].norm(), hit->range_m, 1e-5);
        }
    }
    EXPECT_GT(hits, 500);
}

TEST(WorldCast, gives_a_fan_of_unit_rays_whole_hits) {
    const World world(std::vector<Solid>{solid_of(box_mesh({1.0, 2.0, 2.0}), {3.0, 0.0, 0.0}),
                                         solid_of(ellipsoid_mesh({0.3, 0.3, 0.3}), {1.5, 0.5, 0.0})});
    std::vector<Eigen::Vector3d> directions;
    for (int i = 0; i < 203; ++i) {  // no multiple of a packet's size
        directions.push_back(Eigen::Vector3d(1.0, -0.7 + 0.007 * i, 0.1).normalized());
    }
    std::vector<RayHit> hits(directions.size());
    world.cast_fan({0.0, 0.0, 0.0}, directions, 10.0, hits);
    int of_each[2] = {0, 0};
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const auto hit = world.cast({0.0, 0.0, 0.0}, directions[i], 10.0);
        ASSERT_EQ(hit.has_value(), std::isfinite(hits[i].range_m));
        if (!hit) continue;
        ++of_each[hit->solid];
        EXPECT_NEAR(hits[i].range_m, hit->range_m, 1e-5);
        EXPECT_EQ(hits[i].solid, hit->solid);
        EXPECT_EQ(hits[i].normal, hit->normal);
    }
    EXPECT_GT(of_each[0], 20);
    EXPECT_GT(of_each[1], 20);
}

TEST(WorldCast, meets_a_tilted_ground_of_any_size_where_it_is) {
    const Eigen::Vector3d normal = Eigen::Vector3d(0.48, 0.36, 0.8);
    for (const double size_m : {100.0, 1e3, 1e4, 1e6, 2e9}) {
        const World world = world_of(plane_mesh(normal, {size_m, size_m}));
        std::mt19937_64 random(2);
        std::uniform_real_distribution<double> x(-1.0, 1.0);
        int met = 0;
        for (int i = 0; i < 5000; ++i) {
            const Eigen::Vector3d origin = Eigen::Vector3d(x(random), x(random), x(random)) + 2.0 * normal;
            const Eigen::Vector3d direction =
                (Eigen::Vector3d(x(random), x(random), x(random)) - 1.2 * normal).normalized();
            const double slope = -direction.dot(normal);
            if (slope < 0.05) continue;
            const auto hit = world.cast(origin, direction, kFar_m);
            if (!hit) continue;  // through the edge between the two triangles
            EXPECT_NEAR(hit->range_m, origin.dot(normal) / slope, 1e-5) << size_m;
            EXPECT_NEAR((hit->normal - normal).norm(), 0.0, 1e-9) << size_m;
            ++met;
        }
        EXPECT_GE(met, 4000) << size_m;
    }
}

TEST(WorldCast, does_not_see_what_is_far_away_but_knows_that_it_is_inside) {
    const World world = world_of(box_mesh({4e3, 4e3, 4e3}));
    EXPECT_FALSE(world.cast({0.1, 0.2, 0.3}, Eigen::Vector3d::UnitX(), 1e4));
    EXPECT_TRUE(world.is_inside({0.1, 0.2, 0.3}));
    EXPECT_FALSE(world.is_inside({3e3, 0.2, 0.3}));
}

TEST(WorldInside, knows_the_interior_of_boxes_and_spheres) {
    const World world(std::vector<Solid>{solid_of(box_mesh({1.0, 1.0, 1.0})),
                                         solid_of(ellipsoid_mesh({0.5, 0.5, 0.5}), {2.0, 0.0, 0.0})});
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> x(-1.0, 3.0), y(-1.0, 1.0);
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3d point(x(random), y(random), y(random));
        const double box_gap = point.cwiseAbs().maxCoeff() - 0.5;
        const double sphere_gap = (point - Eigen::Vector3d(2.0, 0.0, 0.0)).norm() - 0.5;
        if (std::abs(box_gap) < 1e-3 || std::abs(sphere_gap) < 1e-3) {
            continue;  // within the facets' error of a surface
        }
        const bool expected = box_gap < 0.0 || sphere_gap < 0.0;
        EXPECT_EQ(world.is_inside(point), expected) << point.transpose();
        inside += expected ? 1 : 0;
    }
    EXPECT_GT(inside, 1000);
}

TEST(WorldInside, is_false_behind_a_plane_which_has_no_interior) {
    const World world = world_of(plane_mesh(Eigen::Vector3d::UnitZ(), {2.0, 2.0}));
    EXPECT_FALSE(world.solids()[0].is_closed);
    EXPECT_FALSE(world.is_inside({0.1, 0.1, -0.1}));
    EXPECT_FALSE(world.is_inside({0.1, 0.1, 0.0}));
}

TEST(WorldSurfaces, cover_a_box_with_gaps_no_wider_than_the_pitch) {
    const World world = world_of(box_mesh({0.1, 0.03, 0.07}));
    std::vector<Eigen::Vector3d> points;
    world.sample_surfaces(0.008, [&](const Eigen::Vector3d& p, std::uint32_t) { points.push_back(p); });
    for (const auto& p : points) {
        EXPECT_NEAR(std::max({std::abs(p.x()) - 0.05, std::abs(p.y()) - 0.015, std::abs(p.z()) - 0.035}), 0.0,
                    1e-12);
    }
    // Any point of the top is within half a diagonal of a cell of 8 mm of some sample.
    for (double x = -0.05; x <= 0.05; x += 0.0013) {
        for (double y = -0.015; y <= 0.015; y += 0.0011) {
            double nearest = 1.0;
            for (const auto& p : points) {
                nearest = std::min(nearest, (p - Eigen::Vector3d(x, y, 0.035)).norm());
            }
            EXPECT_LE(nearest, 0.00566);
        }
    }
}

TEST(WorldSurfaces, leave_out_what_another_solid_buries_or_touches) {
    // The lower box stands on the floor slab; the upper one overlaps it by 5 cm.
    const World world(std::vector<Solid>{solid_of(box_mesh({4.0, 4.0, 0.1}), {0.0, 0.0, -0.05}),
                                         solid_of(box_mesh({0.2, 0.2, 0.2}), {0.0, 0.0, 0.1}),
                                         solid_of(box_mesh({0.2, 0.2, 0.2}), {0.0, 0.0, 0.25})});
    int kept = 0;
    world.sample_surfaces(0.01, [&](const Eigen::Vector3d& p, std::uint32_t solid) {
        const bool is_within_footprint = std::abs(p.x()) < 0.0999 && std::abs(p.y()) < 0.0999;
        const bool is_buried = is_within_footprint && p.z() > -0.05 && p.z() < 0.34;
        EXPECT_FALSE(is_buried) << "solid " << solid << " at " << p.transpose();
        ++kept;
    });
    EXPECT_GT(kept, 1000);
}

TEST(WorldSurfaces, keep_to_the_region_asked_for) {
    const World world = world_of(box_mesh({1.0, 1.0, 1.0}));
    const Eigen::AlignedBox3d region(Eigen::Vector3d(0.0, -0.2, -0.2), Eigen::Vector3d(1.0, 0.2, 0.2));
    int kept = 0;
    world.sample_surfaces(0.02, region, [&](const Eigen::Vector3d& p, std::uint32_t) {
        EXPECT_NEAR(p.x(), 0.5, 1e-12);
        EXPECT_LE(p.tail<2>().cwiseAbs().maxCoeff(), 0.2);
        ++kept;
    });
    EXPECT_GE(kept, 21 * 21);
}

TEST(WorldSurfaces, of_a_ground_without_end_are_had_in_the_region_alone) {
    const World world(std::vector<Solid>{solid_of(plane_mesh(Eigen::Vector3d::UnitZ(), {2e9, 2e9})),
                                         solid_of(box_mesh({0.2, 0.2, 0.2}), {0.0, 0.0, 0.1})});
    const Eigen::AlignedBox3d region(Eigen::Vector3d(-0.5, -0.5, -0.5), Eigen::Vector3d(0.5, 0.5, 0.05));
    int kept = 0;
    world.sample_surfaces(0.01, region, [&](const Eigen::Vector3d& p, std::uint32_t) {
        EXPECT_TRUE(region.contains(p));
        ++kept;
    });
    EXPECT_GT(kept, 9000);
    EXPECT_GT(world.samples_within(0.01, region), kept);
}

TEST(Shapes, are_closed_and_have_their_volumes) {
    constexpr double kPi = 3.141592653589793;
    const auto volume = [](const TriangleMesh& mesh) {
        const auto welded = weld(mesh);
        EXPECT_TRUE(is_closed(welded));
        return signed_volume(welded);
    };
    EXPECT_NEAR(volume(box_mesh({1.0, 2.0, 3.0})), 6.0, 1e-12);
    EXPECT_NEAR(volume(cylinder_mesh(0.5, 2.0)), kPi * 0.25 * 2.0, 2e-3);
    EXPECT_NEAR(volume(ellipsoid_mesh({0.5, 0.6, 0.7})), 4.0 / 3.0 * kPi * 0.21, 3e-3);
    EXPECT_NEAR(volume(capsule_mesh(0.5, 2.0)), kPi * 0.25 * 2.0 + kPi / 6.0, 5e-3);
    EXPECT_FALSE(is_closed(weld(plane_mesh(Eigen::Vector3d::UnitX(), {1.0, 1.0}))));
}

TEST(Shapes, a_mesh_with_one_triangle_missing_or_turned_is_open) {
    TriangleMesh missing = box_mesh({1.0, 1.0, 1.0});
    missing.triangles.pop_back();
    EXPECT_FALSE(is_closed(missing));
    TriangleMesh turned = box_mesh({1.0, 1.0, 1.0});
    std::swap(turned.triangles[5][0], turned.triangles[5][1]);
    EXPECT_FALSE(is_closed(turned));
}

TEST(Shapes, a_plane_faces_along_its_normal) {
    using Vector = Eigen::Vector3d;
    for (const Vector& asked : {Vector(0.0, 0.6, 0.8), Vector(0.0, 0.0, 1.0), Vector(0.0, 0.0, -1.0),
                                Vector(-1.0, 0.0, 0.0), Vector(0.48, -0.64, -0.6)}) {
        const auto mesh = plane_mesh(asked, {1.0, 1.0});
        const auto& t = mesh.triangles[0];
        const auto vertex = [&](int i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
        const Vector normal = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).normalized();
        EXPECT_NEAR((normal - asked).norm(), 0.0, 1e-12);
    }
}

}  // namespace
}  // namespace octoskin::sim
