#include "hw/rigfile/pose.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace octoskin::rig {
namespace {

std::vector<double> read_numbers(const Value& value, const std::string& path, std::size_t count,
                                 double limit) {
    if (value.kind != Value::Kind::list || value.items.size() != count) {
        fail(value, path,
             {ErrorCode::wrong_type, fmt::format("expected a list of {} numbers", count), describe(value)});
    }
    std::vector<double> numbers;
    for (const Value& item : value.items) numbers.push_back(read_number(item, path, {-limit, limit}));
    return numbers;
}

Eigen::Matrix3d read_rpy(const Value& value, const std::string& path) {
    const auto degrees =
        read_numbers(value, path, keys::pose::kRollPitchYaw.count, keys::pose::kRollPitchYaw.range.max);
    const auto turn = [&](std::size_t i, const Eigen::Vector3d& axis) {
        return Eigen::AngleAxisd(degrees[i] * std::numbers::pi / 180.0, axis).toRotationMatrix();
    };
    return turn(2, Eigen::Vector3d::UnitZ()) * turn(1, Eigen::Vector3d::UnitY()) *
           turn(0, Eigen::Vector3d::UnitX());
}

Eigen::Matrix3d read_quaternion(const Value& value, const std::string& path) {
    const auto wxyz =
        read_numbers(value, path, keys::pose::kQuaternion.count, keys::pose::kQuaternion.range.max);
    const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    if (std::abs(q.norm() - 1.0) > keys::pose::kQuaternionTolerance) {
        fail(value, path,
             {ErrorCode::bad_value, "expected a quaternion of length 1", fmt::format("length {}", q.norm()),
              "divide by it"});
    }
    return q.normalized().toRotationMatrix();
}

Eigen::Matrix3d read_rows(const Value& value, const std::string& path) {
    if (value.kind != Value::Kind::list || value.items.size() != 3) {
        fail(value, path, {ErrorCode::wrong_type, "expected a list of 3 rows", describe(value)});
    }
    Eigen::Matrix3d rotation;
    for (int row = 0; row < 3; ++row) {
        const auto numbers = read_numbers(value.items[static_cast<std::size_t>(row)], path, 3,
                                          1.0 + keys::pose::kMatrixTolerance);
        rotation.row(row) << numbers[0], numbers[1], numbers[2];
    }
    const double skew = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (skew > keys::pose::kMatrixTolerance || rotation.determinant() < 0.0) {
        fail(value, path,
             {ErrorCode::bad_value,
              "expected a rotation, with rows of length 1, at right angles, right-handed"});
    }
    return rotation;
}

Eigen::Matrix3d read_looking_at(const Value& value, const std::string& path, const Eigen::Vector3d& p_camera,
                                double reach_m) {
    const Eigen::Vector3d forward = read_position(value, path, reach_m) - p_camera;
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
    if (!(right.norm() > 1e-3 * forward.norm())) {
        fail(value, path,
             {.code = ErrorCode::bad_value,
              .what = "expected a point that is not straight above or below",
              .remedy = "give rpy_deg instead"});
    }
    Eigen::Matrix3d rotation;
    rotation.col(2) = forward.normalized();
    rotation.col(0) = right.normalized();
    rotation.col(1) = rotation.col(2).cross(rotation.col(0));
    return rotation;
}

}  // namespace

Eigen::Vector3d read_position(const Value& value, const std::string& path, double reach_m) {
    const auto xyz = read_numbers(value, path, 3, 1e9);
    Eigen::Vector3d position(xyz[0], xyz[1], xyz[2]);
    if (position.cwiseAbs().maxCoeff() > reach_m) {
        fail(value, path,
             {ErrorCode::out_of_range, fmt::format("expected metres from {} to {}", -reach_m, reach_m),
              fmt::format("({}, {}, {})", xyz[0], xyz[1], xyz[2]), "is it written in millimetres?"});
    }
    return position;
}

Eigen::Vector3d read_position(const Table& table, const NumbersKey& key) {
    return read_position(table.require(key), table.path_of(key), key.range.max);
}

Eigen::Isometry3d read_pose(const Value& value, const std::string& path, const PoseRules& rules) {
    const Table table(value, path, rules.may_look_at_point ? keys::kCameraPose : keys::kPose);
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
    T_parent_child.translation() = read_position(table.require(keys::pose::kPosition),
                                                 table.path_of(keys::pose::kPosition), rules.reach_m);

    int orientations = 0;
    const auto take = [&](const DeclaredKey auto& key, auto read) {
        const Value* orientation = table.find(key);
        if (!orientation) return;
        ++orientations;
        T_parent_child.linear() = read(*orientation, table.path_of(key));
    };
    take(keys::pose::kRollPitchYaw, read_rpy);
    take(keys::pose::kQuaternion, read_quaternion);
    take(keys::pose::kRotationRows, read_rows);
    take(keys::pose::kLookingAt, [&](const Value& point, const std::string& point_path) {
        return read_looking_at(point, point_path, T_parent_child.translation(), rules.reach_m);
    });
    if (orientations != 1) {
        fail(value, path,
             {orientations == 0 ? ErrorCode::missing_key : ErrorCode::conflict, "expected one orientation",
              std::to_string(orientations),
              fmt::format("give rpy_deg or quaternion_wxyz{}",
                          rules.may_look_at_point ? " or looking_at_m" : "")});
    }
    return T_parent_child;
}

}  // namespace octoskin::rig
