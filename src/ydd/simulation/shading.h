// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/simulation/lighting.h"

namespace ydd::sim {

/// All that a pixel on a triangle needs, precomputed in the frame of its body.
struct ShadingTriangle {
  Vector2 uv, uv_by_b, uv_by_c;    ///< texels at the first corner, and towards the others
  Vector3 normal;                  ///< unit, of the flat triangle
  Vector3 u_gradient, v_gradient;  ///< of the texture coordinates, texels per metre
  float light = 0, light_by_b = 0, light_by_c = 0;
};

/// One part, ready to be shaded.
struct Surface {
  const Texture* texture = nullptr;
  int object = -1;
  float glow = 0;
  LightSource source = LightSource::itself;  ///< what the glow goes with
  bool moving = false;
  std::vector<ShadingTriangle> triangles;
  /// Where light changes: at the corners of each triangle; empty for what moves or shines.
  std::vector<std::array<SourceShares, 3>> shares;
  std::vector<std::array<Vector3, 3>> normals;  ///< at the corners; of moving surfaces only
};

/// Camera rays in the frame of a body: direction(x, y) = corner + x * step_x + y * step_y, with
/// unit length along the optical axis.
struct View {
  Vector3 origin;
  Vector3 corner, step_x, step_y;
  Eigen::Matrix3f rotation_world;  ///< body to world
  Vector3 translation_world;

  Vector3 direction(float x, float y) const { return corner + x * step_x + y * step_y; }
};

/// Where a ray met a surface.
struct SurfaceHit {
  const Surface* surface = nullptr;  ///< null: nothing was met
  unsigned group = 0;                ///< body that it belongs to
  unsigned triangle = 0;
  float b = 0, c = 0;  ///< barycentric weights of the second and third corner
  float depth_m = 0;
};

/// `vertex_light` is empty for moving parts, `vertex_shares` also where light is steady.
Surface make_surface(const Part& part, const std::vector<Texture>& textures,
                     const std::vector<float>& vertex_light,
                     const std::vector<SourceShares>& vertex_shares);

/// Colour, 255 is white. `footprint_px` is the side of the pixel area to filter over; `now` is null
/// where light is steady.
Eigen::Array3f shade(const Scene& scene, const LightNow* now, const SurfaceHit& hit,
                     const View& view, float x, float y, float footprint_px);

}  // namespace ydd::sim
