// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "ydd/geometry/se3.h"

namespace ydd::sim {

using Vector3 = Eigen::Vector3f;

/// Triangles with texture coordinates. Coordinates in metres; `uv` in metres on the unrolled
/// surface for materials, or in [0, 1] over the whole picture for panels.
struct Mesh {
  std::vector<Vector3> positions;
  std::vector<Vector3> normals;  ///< unit, outward, one per position
  std::vector<Eigen::Vector2f> uvs;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// One ring of a lofted body: a superellipse |x/a|^n + |y/b|^n = 1 at height z.
struct Ring {
  float z = 0;
  float half_width = 0;  ///< along x
  float half_depth = 0;  ///< along y
  float x = 0;           ///< centre
  float y = 0;
  float power = 2.0F;  ///< 2: ellipse, larger: boxier
};

/// Rectangle with corner `origin`, spanned by `right` and `down` (the picture's axes), facing
/// right x down turned towards the viewer, i.e. the normal is down x right. Cut into cells of at
/// most `cell_m`, whose corners carry baked light. uv in [0, 1].
Mesh make_panel(const Vector3& origin, const Vector3& right, const Vector3& down, float cell_m);

/// Axis-parallel box around `centre`, six faces, uv in metres, each face elsewhere on the material.
Mesh make_box(const Vector3& centre, const Vector3& size, float cell_m = 0.25F);

/// Rings joined in order of rising z and closed at both ends, smooth normals. u runs around in
/// metres (seam at -y), v along in metres.
Mesh make_loft(const std::vector<Ring>& rings, int segments);

/// Solid of revolution about z: (radius, z) from the bottom to the top.
Mesh make_lathe(const std::vector<Eigen::Vector2f>& profile, int segments);

/// Ellipsoid around `centre`. u in [0, 1] is the azimuth (0.5 at +y), v in [0, 1] from top to
/// bottom.
Mesh make_ellipsoid(const Vector3& centre, const Vector3& radii, int segments, int rings);

Mesh transformed(const Mesh& mesh, const SE3& T_parent_mesh);
/// `uv * scale + offset`.
Mesh with_uv(Mesh mesh, const Eigen::Vector2f& scale, const Eigen::Vector2f& offset);
Mesh merged(const std::vector<Mesh>& meshes);

}  // namespace ydd::sim
