// SPDX-License-Identifier: Apache-2.0
#include "to_ros.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include <sensor_msgs/image_encodings.h>

namespace ydd::ros1 {
namespace {

using Vector = std::array<double, 3>;

geometry_msgs::Point point_of(const Vector& p) {
  geometry_msgs::Point out;
  out.x = p[0];
  out.y = p[1];
  out.z = p[2];
  return out;
}

double length_of(const Vector& v) { return std::hypot(v[0], v[1], v[2]); }

sensor_msgs::PointField field_of(const char* name, std::uint32_t offset) {
  sensor_msgs::PointField field;
  field.name = name;
  field.offset = offset;
  field.datatype = sensor_msgs::PointField::FLOAT32;
  field.count = 1;
  return field;
}

visualization_msgs::Marker marker_of(const PortTrack& track, const std_msgs::Header& header,
                                     const char* kind, std::int32_t type) {
  visualization_msgs::Marker out;
  out.header = header;
  out.ns = kind;
  out.id = static_cast<std::int32_t>(track.id % 2'000'000'000);
  out.type = type;
  out.action = visualization_msgs::Marker::ADD;
  out.lifetime = ros::Duration(0.5);
  out.pose.position = point_of(track.position_m);
  out.pose.orientation.w = 1;
  out.color.r = track.moves ? 1.0F : 0.2F;
  out.color.g = track.moves ? 0.4F : 0.8F;
  out.color.b = 0.2F;
  out.color.a = track.unseen_s > 0 ? 0.35F : 0.8F;
  return out;
}

visualization_msgs::Marker name_of(const PortTrack& track, const std_msgs::Header& header) {
  visualization_msgs::Marker out =
      marker_of(track, header, "name", visualization_msgs::Marker::TEXT_VIEW_FACING);
  out.pose.position.z += 0.5 * track.extent_m[1] + 0.15;
  out.scale.z = 0.15;
  std::array<char, 48> speed{};
  std::snprintf(speed.data(), speed.size(), ", %.1f m/s", length_of(track.velocity_m_s));
  out.text = track.class_name + " " + std::to_string(track.id) + speed.data();
  return out;
}

}  // namespace

geometry_msgs::Pose to_ros(const PortPose& pose) {
  geometry_msgs::Pose out;
  out.position = point_of(pose.position_m);
  out.orientation.x = pose.orientation[0];
  out.orientation.y = pose.orientation[1];
  out.orientation.z = pose.orientation[2];
  out.orientation.w = pose.orientation[3];
  return out;
}

geometry_msgs::TransformStamped transform_of(const PortPose& pose, const std_msgs::Header& header,
                                             const std::string& child) {
  geometry_msgs::TransformStamped out;
  out.header = header;
  out.child_frame_id = child;
  out.transform.translation.x = pose.position_m[0];
  out.transform.translation.y = pose.position_m[1];
  out.transform.translation.z = pose.position_m[2];
  out.transform.rotation = to_ros(pose).orientation;
  return out;
}

PortPose from_ros(const geometry_msgs::Transform& t) {
  return {{t.translation.x, t.translation.y, t.translation.z},
          {t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w}};
}

PortImage from_ros(const sensor_msgs::Image& image) {
  return {static_cast<int>(image.width),
          static_cast<int>(image.height),
          image.step,
          image.encoding,
          image.is_bigendian != 0,
          image.data.data(),
          image.data.size(),
          image.width == 0 && image.height == 0};
}

PortCalibration from_ros(const sensor_msgs::CameraInfo& info) {
  PortCalibration out;
  out.width_px = static_cast<int>(info.width);
  out.height_px = static_cast<int>(info.height);
  std::copy(info.K.begin(), info.K.end(), out.K.begin());
  out.D = info.D;
  out.distortion_model = info.distortion_model;
  return out;
}

sensor_msgs::Image image_of(PortPicture picture, const std_msgs::Header& header) {
  sensor_msgs::Image out;
  out.header = header;
  out.width = static_cast<std::uint32_t>(picture.width_px);
  out.height = static_cast<std::uint32_t>(picture.height_px);
  out.encoding = sensor_msgs::image_encodings::BGR8;
  out.step = out.width * 3;
  out.data = std::move(picture.bgr);
  return out;
}

nav_msgs::Path path_of(const std::vector<PortStampedPose>& poses, const std_msgs::Header& header) {
  nav_msgs::Path out;
  out.header = header;
  for (const PortStampedPose& at : poses) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = header.frame_id;
    pose.header.stamp.fromNSec(static_cast<std::uint64_t>(at.stamp_ns));
    pose.pose = to_ros(at.T_map_robot);
    out.poses.push_back(pose);
  }
  return out;
}

sensor_msgs::PointCloud2 cloud_of(const std::vector<PortPoint>& points, bool colours,
                                  const std_msgs::Header& header) {
  const std::uint32_t bytes = colours ? 16 : 12;
  sensor_msgs::PointCloud2 out;
  out.header = header;
  out.height = 1;
  out.width = static_cast<std::uint32_t>(points.size());
  out.fields = {field_of("x", 0), field_of("y", 4), field_of("z", 8)};
  if (colours) out.fields.push_back(field_of("rgb", 12));
  out.is_bigendian = 0U;
  out.is_dense = 1U;
  out.point_step = bytes;
  out.row_step = bytes * out.width;
  out.data.resize(std::size_t{out.row_step});
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::uint8_t* const at = out.data.data() + bytes * i;
    const std::array<float, 3> xyz = {points[i].x, points[i].y, points[i].z};
    std::memcpy(at, xyz.data(), sizeof(xyz));
    if (colours) std::copy(points[i].bgr.begin(), points[i].bgr.end(), at + 12);  // 0x00rrggbb
  }
  return out;
}

nav_msgs::OccupancyGrid grid_of(const PortGrid& grid, const std_msgs::Header& header) {
  nav_msgs::OccupancyGrid out;
  out.header = header;
  out.info.map_load_time = header.stamp;
  out.info.resolution = static_cast<float>(grid.resolution_m);
  out.info.width = static_cast<std::uint32_t>(grid.columns);
  out.info.height = static_cast<std::uint32_t>(grid.rows);
  out.info.origin = to_ros(grid.T_map_origin);
  out.data = grid.cells;
  return out;
}

visualization_msgs::MarkerArray markers_of(const std::vector<PortTrack>& tracks,
                                           const std_msgs::Header& header) {
  using visualization_msgs::Marker;
  visualization_msgs::MarkerArray out;
  for (const PortTrack& track : tracks) {
    Marker body = marker_of(track, header, "body", Marker::CYLINDER);
    body.scale.x = body.scale.y = std::max(0.05, track.extent_m[0]);
    body.scale.z = std::max(0.05, track.extent_m[1]);
    out.markers.push_back(body);
    out.markers.push_back(name_of(track, header));
    if (length_of(track.velocity_m_s) < 0.05) continue;
    Marker way = marker_of(track, header, "way", Marker::ARROW);
    Vector ahead = track.position_m;
    for (std::size_t k = 0; k < 3; ++k) ahead[k] += track.velocity_m_s[k];
    way.points = {point_of(track.position_m), point_of(ahead)};
    way.pose.position = geometry_msgs::Point();
    way.scale.x = 0.05;
    way.scale.y = 0.1;
    out.markers.push_back(way);
  }
  return out;
}

geometry_msgs::PoseArray people_of(const std::vector<PortTrack>& tracks,
                                   const std_msgs::Header& header) {
  geometry_msgs::PoseArray out;
  out.header = header;
  for (const PortTrack& track : tracks) {
    if (!track.person) continue;
    geometry_msgs::Pose pose;
    pose.position = point_of(track.position_m);
    const double half_rad = 0.5 * std::atan2(track.velocity_m_s[1], track.velocity_m_s[0]);
    pose.orientation.z = std::sin(half_rad);
    pose.orientation.w = std::cos(half_rad);
    out.poses.push_back(pose);
  }
  return out;
}

}  // namespace ydd::ros1
