// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "ydd/simulation/scene_builder.h"

/// An articulated person: fifteen rigid bodies on a skeleton. The person's frame stands on the
/// floor between the feet: x to the person's right, y forward, z up.
namespace ydd::sim {

/// Bodies in the order of `make_person_bodies` and `place_person`; pairs are left, right.
inline constexpr int kPelvis = 0;
inline constexpr int kChest = 1;
inline constexpr int kHead = 2;
inline constexpr int kUpperArm = 3;
inline constexpr int kForearm = 5;
inline constexpr int kHand = 7;
inline constexpr int kThigh = 9;
inline constexpr int kShin = 11;
inline constexpr int kFoot = 13;
inline constexpr int kPersonBodies = 15;

/// Sizes in metres, for a person of `scale` 1: 1.76 m.
struct PersonShape {
  double scale = 1.0;
  double hip_half_width = 0.095;
  double thigh = 0.44;
  double shin = 0.42;
  double ankle_height = 0.08;
  double chest_height = 0.1;  ///< waist above the hips
  double shoulder_half_width = 0.20;
  double shoulder_height = 0.40;  ///< above the waist
  double neck_height = 0.46;      ///< above the waist
  double upper_arm = 0.29;
  double forearm = 0.26;
  double palm = 0.09;  ///< wrist to the middle of the palm
};

/// Joint angles in radians; forward and flexing are positive.
struct ArmPose {
  double shoulder = 0;   ///< swings the arm forward
  double spread = 0.12;  ///< away from the body
  double elbow = 0.25;
};
/// Angles of a leg's joints, radians.
struct LegPose {
  double hip = 0;
  double knee = 0.05;
  double ankle = 0;
};
/// Where a person stands and how the limbs are.
struct PersonPose {
  SE3 T_world_person;
  double hip_height_m = -1;  ///< negative: as high as the lower foot on the floor asks for
  double lean = 0.03;        ///< chest forward
  double twist = 0;          ///< chest to the left
  double head_turn = 0;      ///< head to the left, relative to the chest
  double head_nod = 0;
  std::array<ArmPose, 2> arms;  ///< left, right
  std::array<LegPose, 2> legs;
};

/// Indices of the objects that a person consists of.
struct PersonObjects {
  int person = -1;
  int head = -1;
  std::array<int, 2> hands = {-1, -1};
};
PersonObjects add_person_objects(SceneBuilder& builder, int number);

/// Bodies with clothes and face; looks follow from `random`.
std::vector<Body> make_person_bodies(SceneBuilder& builder, const PersonObjects& objects,
                                     const PersonShape& shape, Random random);

/// Forward kinematics: T_world_body for all bodies.
std::vector<SE3> place_person(const PersonShape& shape, const PersonPose& pose);

/// A person of its own looks and a size of 0.94 to `largest_scale`, who moves as `pose_at` says and
/// carries nothing.
void add_person(SceneBuilder& builder, int number, double largest_scale,
                std::function<PersonPose(const PersonShape&, double time_s)> pose_at);

/// Arm whose palm reaches a point given in the person's frame, elbow down; a point out of reach is
/// pointed at. `T_person_chest` from `place_person`'s kChest, or `chest_in_person`.
ArmPose reach(const PersonShape& shape, const SE3& T_person_chest, int side,
              const Eigen::Vector3d& target_person_m);

/// Chest frame in the person's frame for a pose with a given hip height.
SE3 chest_in_person(const PersonShape& shape, const PersonPose& pose, double hip_height_m);

/// Height of the hips above the floor so that the lower foot stands on it.
double standing_hip_height(const PersonShape& shape, const PersonPose& pose);

}  // namespace ydd::sim
