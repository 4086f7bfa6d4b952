// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/person.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "ydd/simulation/motions.h"
#include "ydd/simulation/surfaces.h"

namespace ydd::sim {
namespace {

using Eigen::Vector3d;

// Swings what hangs down forward.
SE3 pitch(double angle_rad) { return turn(Vector3d::UnitX(), angle_rad); }
SE3 roll(double angle_rad) { return turn(Vector3d::UnitY(), angle_rad); }
double sign_of(int side) { return side == 0 ? -1.0 : 1.0; }

SE3 hip_to_thigh(const PersonShape& s, const LegPose& leg, int side) {
  return shift(sign_of(side) * s.hip_half_width * s.scale, 0, 0) * pitch(leg.hip);
}
SE3 thigh_to_shin(const PersonShape& s, const LegPose& leg) {
  return shift(0, 0, -s.thigh * s.scale) * pitch(-leg.knee);
}
SE3 shin_to_foot(const PersonShape& s, const LegPose& leg) {
  return shift(0, 0, -s.shin * s.scale) * pitch(leg.ankle);
}
SE3 hips_to_chest(const PersonShape& s, const PersonPose& pose) {
  return shift(0, 0, s.chest_height * s.scale) * yaw(pose.twist) * pitch(-pose.lean);
}
Vector3d shoulder_in_chest(const PersonShape& s, int side) {
  return {sign_of(side) * s.shoulder_half_width * s.scale, 0, s.shoulder_height * s.scale};
}

/// Everything that a person wears, as textures, and the objects that the parts belong to.
class Tailor {
 public:
  Tailor(SceneBuilder& builder, const PersonObjects& objects, const PersonShape& shape,
         Random random)
      : builder_(builder), objects_(objects), shape_(shape), random_(random) {
    texel_m_ = 0.6F * builder.texel_m();
    const int first = random_.integer(0, kClothKinds - 1);
    const int second = (first + random_.integer(1, kClothKinds - 1)) % kClothKinds;
    shirt_ = cloth(static_cast<Cloth>(first));
    trousers_ = cloth(static_cast<Cloth>(second));
    tone_ = Colour(bgr(0.48F, 0.60F, 0.82F) * random_.uniform_f(0.55F, 1.05F));
    skin_ = builder.add_texture(paint_plain(random_.fork(5), 128, tone_, 0.05F), Wrap::repeat);
    const float value = random_.uniform_f(0.08F, 0.45F);
    const float saturation = random_.uniform_f(0.2F, 0.7F);
    const Colour hair = hsv(random_.uniform_f(0.02F, 0.1F), saturation, value);
    face_ = builder.add_texture(paint_head(random_.fork(6), 512, 256, tone_, hair));
  }

  Body pelvis();
  Body chest();
  Body head();
  Body upper_arm();
  Body forearm();
  Body hand(int side);
  Body thigh();
  Body shin();
  Body foot();

 private:
  int cloth(Cloth kind) {
    // 512 texels are about a metre: nothing repeats on one body.
    return builder_.add_texture(
        paint_cloth(random_.fork(10 + static_cast<std::uint64_t>(kind)), 512, texel_m_, kind),
        Wrap::repeat);
  }
  float m(double metres) const { return static_cast<float>(metres * shape_.scale); }
  Part sewn(Mesh mesh, int texture, int object) {
    Part part = builder_.cut(std::move(mesh), texture, object);
    part.texels_per_uv.setConstant(1.0F / texel_m_);
    return part;
  }
  /// A limb that hangs down `length`, rings at given fractions of it from below.
  Mesh limb(double length, const std::vector<std::array<double, 3>>& z_width_depth,
            int segments = 14) const {
    std::vector<Ring> rings;
    for (const auto& [z, width, depth] : z_width_depth) {
      rings.push_back({m(-length + z * length), m(width), m(depth), 0, 0, 2.3F});
    }
    return make_loft(rings, segments);
  }

  SceneBuilder& builder_;
  PersonObjects objects_;
  PersonShape shape_;
  Random random_;
  float texel_m_ = 0;
  Colour tone_;
  int shirt_ = 0;
  int trousers_ = 0;
  int skin_ = 0;
  int face_ = 0;
};

Body Tailor::pelvis() {
  const Mesh hips = make_loft({{m(-0.10), m(0.12), m(0.09), 0, 0, 2.6F},
                               {m(-0.04), m(0.168), m(0.115), 0, 0, 2.6F},
                               {m(0.03), m(0.172), m(0.115), 0, 0, 2.6F},
                               {m(0.10), m(0.152), m(0.105), 0, 0, 2.5F}},
                              24);
  return {{sewn(hips, trousers_, objects_.person)}};
}

Body Tailor::chest() {
  const Mesh trunk = make_loft({{m(-0.09), m(0.165), m(0.118), 0, 0, 2.6F},
                                {m(0.0), m(0.155), m(0.11), 0, 0, 2.6F},
                                {m(0.12), m(0.165), m(0.118), 0, 0, 2.6F},
                                {m(0.27), m(0.185), m(0.125), 0, 0, 2.6F},
                                {m(0.36), m(0.195), m(0.11), 0, m(-0.005), 2.6F},
                                {m(0.415), m(0.175), m(0.085), 0, m(-0.01), 2.5F},
                                {m(0.445), m(0.11), m(0.07), 0, m(-0.01), 2.2F},
                                {m(0.46), m(0.07), m(0.06), 0, m(-0.01), 2.0F}},
                               28);
  return {{sewn(trunk, shirt_, objects_.person)}};
}

Body Tailor::head() {
  const Mesh neck = make_loft({{m(-0.03), m(0.058), m(0.06), 0, m(-0.01)},
                               {m(0.04), m(0.052), m(0.055), 0, 0},
                               {m(0.10), m(0.055), m(0.06), 0, m(0.01)}},
                              16);
  const Vector3 centre(0, m(0.02), m(0.155));
  const Mesh skull = make_ellipsoid(centre, {m(0.079), m(0.1), m(0.122)}, 28, 20);
  const Mesh nose = make_ellipsoid(centre + Vector3(0, m(0.098), m(-0.018)),
                                   {m(0.014), m(0.022), m(0.024)}, 10, 8);
  Body body;
  body.parts.push_back(sewn(neck, skin_, objects_.person));
  body.parts.push_back(builder_.covered(skull, face_, objects_.head));
  body.parts.push_back(sewn(with_uv(nose, {0.1F, 0.1F}, {0, 0}), skin_, objects_.head));
  for (const float side : {-1.0F, 1.0F}) {
    const Mesh ear = make_ellipsoid(centre + Vector3(side * m(0.079), m(-0.005), m(-0.01)),
                                    {m(0.012), m(0.022), m(0.034)}, 8, 8);
    body.parts.push_back(sewn(with_uv(ear, {0.1F, 0.1F}, {0, 0}), skin_, objects_.head));
  }
  return body;
}

Body Tailor::upper_arm() {
  return {{sewn(limb(shape_.upper_arm, {{-0.06, 0.036, 0.038},
                                        {0.0, 0.042, 0.044},
                                        {0.5, 0.052, 0.055},
                                        {0.85, 0.06, 0.064},
                                        {1.05, 0.055, 0.058},
                                        {1.15, 0.035, 0.038}}),
                shirt_, objects_.person)}};
}

Body Tailor::forearm() {
  return {{sewn(limb(shape_.forearm, {{0.02, 0.028, 0.032},
                                      {0.1, 0.03, 0.035},
                                      {0.7, 0.044, 0.046},
                                      {0.95, 0.042, 0.044},
                                      {1.08, 0.03, 0.032}}),
                shirt_, objects_.person)}};
}

Body Tailor::hand(int side) {
  const auto inward = static_cast<float>(-sign_of(side));
  std::vector<Mesh> flesh;
  flesh.push_back(make_loft({{m(-0.105), m(0.013), m(0.038), 0, 0, 3},
                             {m(-0.06), m(0.017), m(0.043), 0, 0, 3},
                             {m(-0.01), m(0.018), m(0.032), 0, 0, 2.5F},
                             {m(0.03), m(0.02), m(0.026), 0, 0, 2}},
                            14));
  for (int finger = 0; finger < 4; ++finger) {
    const double y = 0.03 - 0.02 * finger;
    const Mesh joint = make_loft({{m(-0.075), m(0.006), m(0.007)},
                                  {m(-0.035), m(0.008), m(0.009)},
                                  {m(0.005), m(0.009), m(0.0095)}},
                                 8);
    const SE3 T =
        shift(0, y * shape_.scale, -0.1 * shape_.scale) * roll(static_cast<double>(-inward) * 0.35);
    flesh.push_back(transformed(joint, T));
  }
  const Mesh thumb = make_loft({{m(-0.065), m(0.008), m(0.009)},
                                {m(-0.02), m(0.011), m(0.012)},
                                {m(0.01), m(0.01), m(0.012)}},
                               8);
  flesh.push_back(transformed(thumb, shift(0.012 * static_cast<double>(inward) * shape_.scale,
                                           0.034 * shape_.scale, -0.035 * shape_.scale) *
                                         pitch(0.55)));
  return {{sewn(merged(flesh), skin_, objects_.hands[side])}};
}

Body Tailor::thigh() {
  return {{sewn(limb(shape_.thigh, {{-0.04, 0.055, 0.055},
                                    {0.05, 0.062, 0.064},
                                    {0.5, 0.078, 0.084},
                                    {0.9, 0.092, 0.1},
                                    {1.08, 0.07, 0.08}}),
                trousers_, objects_.person)}};
}

Body Tailor::shin() {
  return {{sewn(limb(shape_.shin, {{-0.04, 0.05, 0.055},
                                   {0.05, 0.048, 0.052},
                                   {0.6, 0.06, 0.066},
                                   {0.9, 0.062, 0.064},
                                   {1.05, 0.05, 0.052}}),
                trousers_, objects_.person)}};
}

Body Tailor::foot() {
  const Mesh shoe =
      make_ellipsoid({0, m(0.055), m(-0.035)}, {m(0.047), m(0.135), m(0.045)}, 16, 10);
  return {{builder_.cut(with_uv(shoe, {0.3F, 0.3F}, {0, 0}), builder_.palette().black,
                        objects_.person)}};
}

}  // namespace

PersonObjects add_person_objects(SceneBuilder& builder, int number) {
  const std::string name = fmt::format("person{}", number);
  PersonObjects objects;
  objects.person = builder.add_mover("person", name);
  objects.head = builder.add_limb(objects.person, "head", name + "_head");
  objects.hands[0] = builder.add_limb(objects.person, "hand", name + "_left_hand");
  objects.hands[1] = builder.add_limb(objects.person, "hand", name + "_right_hand");
  return objects;
}

std::vector<Body> make_person_bodies(SceneBuilder& builder, const PersonObjects& objects,
                                     const PersonShape& shape, Random random) {
  Tailor tailor(builder, objects, shape, random);
  return {tailor.pelvis(),    tailor.chest(),   tailor.head(),    tailor.upper_arm(),
          tailor.upper_arm(), tailor.forearm(), tailor.forearm(), tailor.hand(0),
          tailor.hand(1),     tailor.thigh(),   tailor.thigh(),   tailor.shin(),
          tailor.shin(),      tailor.foot(),    tailor.foot()};
}

double standing_hip_height(const PersonShape& s, const PersonPose& pose) {
  double lowest = 0;
  for (int side = 0; side < 2; ++side) {
    const LegPose& leg = pose.legs[side];
    const SE3 ankle = hip_to_thigh(s, leg, side) * thigh_to_shin(s, leg) * shin_to_foot(s, leg);
    lowest = std::min(lowest, ankle.translation().z());
  }
  return s.ankle_height * s.scale - lowest;
}

SE3 chest_in_person(const PersonShape& shape, const PersonPose& pose, double hip_height_m) {
  return shift(0, 0, hip_height_m) * hips_to_chest(shape, pose);
}

void add_person(SceneBuilder& builder, int number, double largest_scale,
                std::function<PersonPose(const PersonShape&, double time_s)> pose_at) {
  Random random = builder.next_random();
  PersonShape shape;
  shape.scale = random.uniform(0.94, largest_scale);
  const PersonObjects objects = add_person_objects(builder, number);
  Actor actor;
  actor.bodies = make_person_bodies(builder, objects, shape, random.fork(1));
  actor.poses = [shape, pose_at = std::move(pose_at)](double t) {
    return place_person(shape, pose_at(shape, t));
  };
  builder.add_actor(std::move(actor));
}

std::vector<SE3> place_person(const PersonShape& s, const PersonPose& pose) {
  const double hip_height =
      pose.hip_height_m < 0 ? standing_hip_height(s, pose) : pose.hip_height_m;
  std::vector<SE3> T(kPersonBodies);
  T[kPelvis] = pose.T_world_person * shift(0, 0, hip_height);
  T[kChest] = T[kPelvis] * hips_to_chest(s, pose);
  T[kHead] = T[kChest] * shift(0, 0, s.neck_height * s.scale) * yaw(pose.head_turn) *
             pitch(pose.lean - pose.head_nod);
  for (int side = 0; side < 2; ++side) {
    const ArmPose& arm = pose.arms[side];
    T[kUpperArm + side] = T[kChest] *
                          SE3(Eigen::Quaterniond::Identity(), shoulder_in_chest(s, side)) *
                          pitch(arm.shoulder) * roll(-sign_of(side) * arm.spread);
    T[kForearm + side] =
        T[kUpperArm + side] * shift(0, 0, -s.upper_arm * s.scale) * pitch(arm.elbow);
    T[kHand + side] = T[kForearm + side] * shift(0, 0, -s.forearm * s.scale);
    const LegPose& leg = pose.legs[side];
    T[kThigh + side] = T[kPelvis] * hip_to_thigh(s, leg, side);
    T[kShin + side] = T[kThigh + side] * thigh_to_shin(s, leg);
    T[kFoot + side] = T[kShin + side] * shin_to_foot(s, leg);
  }
  return T;
}

ArmPose reach(const PersonShape& s, const SE3& T_person_chest, int side,
              const Vector3d& target_person_m) {
  const Vector3d to = T_person_chest.inverse() * target_person_m - shoulder_in_chest(s, side);
  const double upper = s.upper_arm * s.scale;
  const double lower = (s.forearm + s.palm) * s.scale;
  const double distance =
      std::clamp(to.norm(), std::abs(upper - lower) + 0.02, upper + lower - 0.005);
  const double inner = (upper * upper + lower * lower - distance * distance) / (2 * upper * lower);
  ArmPose arm;
  arm.elbow = std::numbers::pi - std::acos(std::clamp(inner, -1.0, 1.0));
  const double lag = std::atan2(lower * std::sin(arm.elbow), upper + lower * std::cos(arm.elbow));
  arm.shoulder = std::atan2(to.y(), -to.z()) - lag;
  // The spread turns the whole arm about its own y axis: sideways by the sine of it.
  arm.spread =
      std::clamp(sign_of(side) * std::asin(std::clamp(to.x() / distance, -0.6, 0.6)), -0.5, 0.8);
  return arm;
}

}  // namespace ydd::sim
