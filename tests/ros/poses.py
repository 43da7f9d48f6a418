"""Rigid transforms and the kinematics of a robot, written without octoskin's code."""
import math


def turned(q, v):
    """A vector turned by the unit quaternion (x, y, z, w)."""
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
            v[2] + w * t[2] + x * t[1] - y * t[0]]


def product(a, b):
    """The quaternion of b, then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def moved(T, point):
    """T = {"p": [...], "q": [...]} of a point."""
    return [a + b for a, b in zip(T["p"], turned(T["q"], point))]


def chained(A, B):
    return {"p": moved(A, B["p"]), "q": product(A["q"], B["q"])}


def joint_pose(joint, position):
    if joint["kind"] == "fixed":
        return joint["T_parent_joint"]
    if joint["kind"] == "prismatic":
        motion = {"p": [position * a for a in joint["axis"]], "q": [0, 0, 0, 1]}
    else:
        half = position / 2
        motion = {"p": [0, 0, 0], "q": [*(math.sin(half) * a for a in joint["axis"]), math.cos(half)]}
    return chained(joint["T_parent_joint"], motion)


def links(described, positions):
    """The pose of each link in the root's frame; `positions`: by joint."""
    poses = {described["base_link"]: described["T_root_base"]}
    for joint in described["joints"]:  # parents come first
        poses[joint["child"]] = chained(poses[joint["parent"]], joint_pose(joint, positions.get(joint["name"], 0.0)))
    return poses


def body(described, positions):
    """The capsules of the robot's body in the root's frame, as moveit_stand_in takes them."""
    poses = links(described, positions)
    return [{"a": moved(poses[capsule["link"]], capsule["a"]), "b": moved(poses[capsule["link"]], capsule["b"]),
             "radius": capsule["radius_m"]} for capsule in described["body"]]
