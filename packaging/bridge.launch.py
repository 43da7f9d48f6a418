"""Starts the bridge with the other nodes of a robot: ros2 launch ./bridge.launch.py"""
from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description():
    # The environment of the launch (ROS_DOMAIN_ID and the like) holds for the bridge, too.
    return LaunchDescription([
        ExecuteProcess(
            cmd=["octoskin", "bridge", "run", "--joint-states", "/joint_states"],
            output="screen",
            respawn=True,
            respawn_delay=1.0,
        ),
    ])
