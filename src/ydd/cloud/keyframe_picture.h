// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/dynamics/point_rules.h"
#include "ydd/evidence/motion_odds.h"
#include "ydd/image/image.h"
#include "ydd/map/map_types.h"

namespace ydd {

/// A frame as it was taken, and what was judged to move in it.
struct PictureSource {
  ColourImage colour;                           ///< as the camera took it
  DepthImage depth_m;                           ///< registered to colour, metres; 0: no reading
  std::vector<MovingRegion> moving;             ///< what is cut out of both
  std::shared_ptr<const MotionOdds> odds = {};  ///< of its surfaces; null: not asked for
  std::vector<Box> people = {};                 ///< people_boxes of the frame
  bool looked = false;                          ///< for people, in this very frame
};

/// Which pixels of the half-size picture are left out: row by row, true where something moves.
///
/// More is left out than the rules for points reject: in the grown box of a region everything that
/// is not clearly behind it, and a margin around its silhouette. A hole in one picture is filled by
/// the next; a ghost in the cloud stays.
std::vector<bool> moving_mask(const DepthImage& half_m, std::span<const MovingRegion> moving);

/// Half as wide and high; what moves is cut out, and all of every box in which there may be
/// somebody, whether they move or not and however far what is seen in it. A pixel has depth only if
/// its readings agree, so that none lies between two surfaces.
KeyFramePicture make_keyframe_picture(const PictureSource& source);

/// Whether somebody looked for people in the frame of the picture, so that no box of them is in it.
bool people_left_out(const KeyFramePicture& picture);

/// A picture as pixels again.
struct OpenPicture {
  ColourImage colour;      ///< neutral grey where there is no depth
  RawDepthImage depth_mm;  ///< 0: none
};
/// Failure: the reason only.
Result<OpenPicture> open_keyframe_picture(const KeyFramePicture& picture);

}  // namespace ydd
