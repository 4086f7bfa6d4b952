// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/ray_scene.h"

#include <stdexcept>

namespace ydd::sim {
namespace {

RayScene new_scene(const Device& device) {
  // Robust: edges that two triangles share let no ray through.
  RTCScene scene = rtcNewScene(device.get());
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  // The deleter keeps the device alive for as long as the scene.
  return {scene, [device](RTCScene s) { rtcReleaseScene(s); }};
}

void attach_mesh(RTCDevice device, RTCScene scene, const Mesh& mesh, unsigned id) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.positions.size()));
  for (const Vector3& p : mesh.positions) {
    for (int k = 0; k < 3; ++k) *vertices++ = p[k];
  }
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) *indices++ = v;
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

}  // namespace

Device make_device() {
  RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) throw std::runtime_error("Embree does not start on this machine");
  return {device, rtcReleaseDevice};
}

RayScene make_ray_scene(const Device& device, const std::vector<Part>& parts) {
  RayScene scene = new_scene(device);
  unsigned id = 0;
  for (const Part& part : parts) attach_mesh(device.get(), scene.get(), part.mesh, id++);
  rtcCommitScene(scene.get());
  return scene;
}

RayScene make_instance_scene(const Device& device, const std::vector<RayScene>& groups,
                             const std::vector<SE3>& T_world_group) {
  RayScene scene = new_scene(device);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    RTCGeometry instance = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, groups[i].get());
    const Eigen::Matrix<float, 3, 4> matrix =
        T_world_group[i].matrix().topRows<3>().cast<float>();  // column-major, as Embree wants it
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(scene.get(), instance, static_cast<unsigned>(i));
    rtcReleaseGeometry(instance);
  }
  rtcCommitScene(scene.get());
  return scene;
}

// What Embree 3 calls a context are arguments in Embree 4.
#ifdef YDD_EMBREE4
void intersect(RTCScene scene, const int* valid, RTCRayHit8& rays, bool coherent) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &rays, &arguments);
}

void find_occluded(RTCScene scene, const int* valid, RTCRay8& rays, bool coherent) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded8(valid, scene, &rays, &arguments);
}

void find_occluded(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }
#else
namespace {

RTCIntersectContext context_of(bool coherent) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

}  // namespace

void intersect(RTCScene scene, const int* valid, RTCRayHit8& rays, bool coherent) {
  RTCIntersectContext context = context_of(coherent);
  rtcIntersect8(valid, scene, &context, &rays);
}

void find_occluded(RTCScene scene, const int* valid, RTCRay8& rays, bool coherent) {
  RTCIntersectContext context = context_of(coherent);
  rtcOccluded8(valid, scene, &context, &rays);
}

void find_occluded(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context = context_of(false);
  rtcOccluded1(scene, &context, &ray);
}
#endif

}  // namespace ydd::sim
