"""RViz on a running conav.

    ros2 launch deploy/ros2/conav.launch.py                        # robot r1 of world w1
    ros2 launch deploy/ros2/conav.launch.py robot:=r2
    ros2 launch deploy/ros2/conav.launch.py fleet:=true            # r1 and r2 at once

No robot_state_publisher: all joints are fixed, and conav publishes their transforms itself.
"""

import pathlib
import tempfile

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

FOLDER = pathlib.Path(__file__).resolve().parent


def rviz(context):
    robot = LaunchConfiguration("robot").perform(context)
    world = LaunchConfiguration("world").perform(context)
    fleet = LaunchConfiguration("fleet").perform(context).lower() == "true"
    text = (FOLDER / ("fleet.rviz" if fleet else "conav.rviz")).read_text()
    text = text.replace("/w1/", f"/{world}/")
    if not fleet:
        text = text.replace("/r1/", f"/{robot}/")
    config = tempfile.NamedTemporaryFile("w", suffix=".rviz", delete=False)
    config.write(text)
    config.close()
    # The tree of one robot has plain frame ids and its own topics; that of the fleet is on /tf.
    remappings = [("/tf", f"/{robot}/tf"), ("/tf_static", f"/{robot}/tf_static")]
    return [
        Node(
            package="rviz2",
            executable="rviz2",
            output="screen",
            arguments=["-d", config.name],
            parameters=[{"use_sim_time": LaunchConfiguration("use_sim_time").perform(context) == "true"}],
            remappings=[] if fleet else remappings,
        )
    ]


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot", default_value="r1"),
            DeclareLaunchArgument("world", default_value="w1"),
            DeclareLaunchArgument("fleet", default_value="false", description="r1 and r2 in one tree"),
            DeclareLaunchArgument("use_sim_time", default_value="true", description="false for real robots"),
            OpaqueFunction(function=rviz),
        ]
    )
