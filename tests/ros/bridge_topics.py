"""The topics that the bridge publishes."""

TOPICS = {"/planning_scene": "moveit_msgs/PlanningScene", "/octoskin/octomap_binary": "octomap_msgs/Octomap",
          "/octoskin/octomap_full": "octomap_msgs/Octomap", "/octoskin/occupied": "sensor_msgs/PointCloud2",
          "/octoskin/occupied_cells_vis_array": "visualization_msgs/MarkerArray",
          "/octoskin/projected_map": "nav_msgs/OccupancyGrid", "/diagnostics": "diagnostic_msgs/DiagnosticArray",
          "/tf_static": "tf2_msgs/TFMessage", "/octoskin/points": "sensor_msgs/PointCloud2",
          "/octoskin/range/n1_s0": "sensor_msgs/Range"}
VOLATILE = ("/diagnostics", "/octoskin/points", "/octoskin/range/n1_s0")
LATE = ("--durability", "transient_local")


def pairs(topics):
    return [word for topic in topics for word in (topic, TOPICS[topic])]
