// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ydd::sim {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Cells of at most `cell_m` along `length_m`.
int cells(float length_m, float cell_m) {
  return std::clamp(static_cast<int>(std::ceil(length_m / cell_m - 1e-4F)), 1, 64);
}

std::uint32_t vertex_count(const Mesh& mesh) {
  return static_cast<std::uint32_t>(mesh.positions.size());
}

/// Two triangles per cell of a grid of vertices, `columns` + 1 in a row, starting at `first`.
void append_grid(Mesh& mesh, std::uint32_t first, int columns, int rows) {
  const auto width = static_cast<std::uint32_t>(columns + 1);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const std::uint32_t a =
          first + static_cast<std::uint32_t>(r) * width + static_cast<std::uint32_t>(c);
      mesh.triangles.push_back({a, a + 1, a + width});
      mesh.triangles.push_back({a + 1, a + width + 1, a + width});
    }
  }
}

float signed_power(float value, float exponent) {
  return std::copysign(std::pow(std::abs(value), exponent), value);
}

/// Point of a ring at `turn` in [0, 1], starting at -y, seen from above anticlockwise.
Vector3 ring_point(const Ring& ring, float turn) {
  const float angle = 2.0F * kPi * turn - 0.5F * kPi;
  const float exponent = 2.0F / ring.power;
  return {ring.x + ring.half_width * signed_power(std::cos(angle), exponent),
          ring.y + ring.half_depth * signed_power(std::sin(angle), exponent), ring.z};
}

/// Smooth normals as the mean of the triangles' around each position; positions that coincide
/// (seams) share theirs.
void smooth_normals(Mesh& mesh, int columns) {
  std::vector<Vector3> sums(mesh.positions.size(), Vector3::Zero());
  for (const auto& t : mesh.triangles) {
    const Vector3 n = (mesh.positions[t[1]] - mesh.positions[t[0]])
                          .cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (const std::uint32_t v : t) sums[v] += n;
  }
  const std::size_t width = static_cast<std::size_t>(columns) + 1;
  for (std::size_t first = 0; first + width <= sums.size(); first += width) {
    const Vector3 seam = sums[first] + sums[first + width - 1];
    sums[first] = sums[first + width - 1] = seam;
  }
  mesh.normals.clear();
  for (const Vector3& n : sums) mesh.normals.push_back(n.stableNormalized());
}

std::vector<Ring> with_caps(const std::vector<Ring>& rings) {
  std::vector<Ring> closed;
  const auto cap = [](Ring ring) {
    ring.half_width *= 1e-3F;
    ring.half_depth *= 1e-3F;
    return ring;
  };
  closed.push_back(cap(rings.front()));
  closed.insert(closed.end(), rings.begin(), rings.end());
  closed.push_back(cap(rings.back()));
  return closed;
}

}  // namespace

Mesh make_panel(const Vector3& origin, const Vector3& right, const Vector3& down, float cell_m) {
  Mesh mesh;
  const int columns = cells(right.norm(), cell_m);
  const int rows = cells(down.norm(), cell_m);
  const Vector3 normal = down.cross(right).normalized();
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const float u = static_cast<float>(c) / static_cast<float>(columns);
      const float v = static_cast<float>(r) / static_cast<float>(rows);
      mesh.positions.emplace_back(origin + u * right + v * down);
      mesh.normals.push_back(normal);
      mesh.uvs.emplace_back(u, v);
    }
  }
  append_grid(mesh, 0, columns, rows);
  return mesh;
}

Mesh make_box(const Vector3& centre, const Vector3& size, float cell_m) {
  const Vector3 h = 0.5F * size;
  const Vector3 x(size.x(), 0, 0);
  const Vector3 y(0, size.y(), 0);
  const Vector3 z(0, 0, size.z());
  const auto corner = [&](float sx, float sy, float sz) {
    return Vector3(centre + Vector3(sx * h.x(), sy * h.y(), sz * h.z()));
  };
  // Front (-y), back, left (-x), right, top, bottom; each as seen from outside.
  const std::array<Mesh, 6> faces = {
      make_panel(corner(-1, -1, 1), x, -z, cell_m), make_panel(corner(1, 1, 1), -x, -z, cell_m),
      make_panel(corner(-1, 1, 1), -y, -z, cell_m), make_panel(corner(1, -1, 1), y, -z, cell_m),
      make_panel(corner(-1, 1, 1), x, -y, cell_m),  make_panel(corner(-1, -1, -1), x, y, cell_m)};
  const std::array<Eigen::Vector2f, 6> extents = {
      Eigen::Vector2f(size.x(), size.z()), Eigen::Vector2f(size.x(), size.z()),
      Eigen::Vector2f(size.y(), size.z()), Eigen::Vector2f(size.y(), size.z()),
      Eigen::Vector2f(size.x(), size.y()), Eigen::Vector2f(size.x(), size.y())};
  std::vector<Mesh> parts;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Eigen::Vector2f offset(0.37F * static_cast<float>(i), 0.61F * static_cast<float>(i));
    parts.push_back(with_uv(faces[i], extents[i], offset));
  }
  return merged(parts);
}

Mesh make_loft(const std::vector<Ring>& open_rings, int segments) {
  const std::vector<Ring> rings = with_caps(open_rings);
  Mesh mesh;
  float along = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    if (r > 0) {
      along += (ring_point(rings[r], 0.25F) - ring_point(rings[r - 1], 0.25F)).norm();
    }
    // Texture width follows the widest ring, so that patterns taper with the limb.
    float girth = 0;
    for (const Ring& ring : rings) girth = std::max(girth, ring.half_width + ring.half_depth);
    for (int s = 0; s <= segments; ++s) {
      const float turn = static_cast<float>(s) / static_cast<float>(segments);
      mesh.positions.push_back(ring_point(rings[r], turn));
      mesh.uvs.emplace_back(kPi * girth * turn, along);
    }
  }
  append_grid(mesh, 0, segments, static_cast<int>(rings.size()) - 1);
  smooth_normals(mesh, segments);
  return mesh;
}

Mesh make_lathe(const std::vector<Eigen::Vector2f>& profile, int segments) {
  std::vector<Ring> rings;
  rings.reserve(profile.size());
  for (const Eigen::Vector2f& p : profile) rings.push_back({p.y(), p.x(), p.x()});
  return make_loft(rings, segments);
}

Mesh make_ellipsoid(const Vector3& centre, const Vector3& radii, int segments, int rings) {
  Mesh mesh;
  for (int r = 0; r <= rings; ++r) {
    const float v = static_cast<float>(r) / static_cast<float>(rings);
    const float polar = kPi * std::clamp(1.0F - v, 1e-3F, 1.0F - 1e-3F);  // from the bottom up
    for (int s = 0; s <= segments; ++s) {
      const float u = static_cast<float>(s) / static_cast<float>(segments);
      const float azimuth = 2.0F * kPi * u - 0.5F * kPi;
      const Vector3 n(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                      std::cos(polar));
      mesh.positions.emplace_back(centre + n.cwiseProduct(radii));
      mesh.normals.push_back(n.cwiseQuotient(radii).normalized());
      mesh.uvs.emplace_back(u, 1.0F - v);
    }
  }
  append_grid(mesh, 0, segments, rings);
  return mesh;
}

Mesh transformed(const Mesh& mesh, const SE3& T_parent_mesh) {
  const Eigen::Matrix3f rotation = T_parent_mesh.rotation_matrix().cast<float>();
  const Vector3 translation = T_parent_mesh.translation().cast<float>();
  Mesh moved = mesh;
  for (Vector3& p : moved.positions) p = (rotation * p + translation).eval();
  for (Vector3& n : moved.normals) n = (rotation * n).eval();
  return moved;
}

Mesh with_uv(Mesh mesh, const Eigen::Vector2f& scale, const Eigen::Vector2f& offset) {
  for (Eigen::Vector2f& uv : mesh.uvs) uv = (uv.cwiseProduct(scale) + offset).eval();
  return mesh;
}

Mesh merged(const std::vector<Mesh>& meshes) {
  Mesh all;
  for (const Mesh& mesh : meshes) {
    const std::uint32_t first = vertex_count(all);
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
    all.uvs.insert(all.uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    for (const auto& t : mesh.triangles) {
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  return all;
}

}  // namespace ydd::sim
