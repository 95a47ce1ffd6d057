# SPDX-License-Identifier: BSD-3-Clause
# Writes a bag with Debian's rosbag, for recording_writer_test.cpp: write_ros1_bag.py FILE none|bz2|lz4
import struct
import sys

import rosbag
import rospy
from sensor_msgs.msg import Imu, PointCloud2, PointField

path, compression = sys.argv[1:]
with rosbag.Bag(path, "w", compression=compression, chunk_threshold=4096) as bag:
    for i in range(300):
        t = rospy.Time(1000, 1000000 * i)
        imu = Imu()
        imu.header.stamp = t
        imu.header.frame_id = "imu_link"
        imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z = 0.5, -0.25, i
        imu.linear_acceleration.x, imu.linear_acceleration.z = 0.125 * i, 9.75
        bag.write("/imu", imu, t + rospy.Duration(0, 500))
        if i % 10:
            continue
        cloud = PointCloud2()
        cloud.header.stamp = t
        cloud.height, cloud.width, cloud.point_step = 1, 2, 20
        cloud.row_step = cloud.width * cloud.point_step
        cloud.is_dense = True
        cloud.fields = [PointField(name, 4 * k, PointField.FLOAT32, 1)
                        for k, name in enumerate(["x", "y", "z", "intensity", "velocity"])]
        cloud.data = struct.pack("<10f", 1, 2, 3, 10, -0.5, 4, 5, 6, 20, i)
        bag.write("/radar", cloud, t + rospy.Duration(0, 700))
