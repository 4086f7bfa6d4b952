// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/simulation/canvas.h"

/// Painted surfaces of the room and its people. Sizes in texels, `texel_m` the size of a texel.
/// Everything comes from the generator, nothing repeats, no files are read.
namespace ydd::sim {

/// Painted plaster: soft clouds, roller marks, a few scuffs. `contrast` 1 is a used office.
Canvas paint_plaster(Random random, int width, int height, const Colour& base, float contrast);
/// Boards with grain and joints, each of another shade.
Canvas paint_boards(Random random, int width, int height, float texel_m);
/// Suspended ceiling: square tiles with speckles.
Canvas paint_ceiling(Random random, int width, int height, float texel_m);
/// Rug: borders and a mosaic of motifs.
Canvas paint_rug(Random random, int width, int height, float texel_m);
/// Wood grain along x; `side` a power of two.
Canvas paint_wood(Random random, int side, const Colour& base);
/// Plastic, metal, leather: nearly plain with fine grain; `side` a power of two.
Canvas paint_plain(Random random, int side, const Colour& base, float grain);

/// How clothes are printed, from loud to louder.
enum class Cloth { checks, stripes, dots, blocks, flowers, letters };
inline constexpr int kClothKinds = 6;
/// Strongly patterned cloth; `side` a power of two.
Canvas paint_cloth(Random random, int side, float texel_m, Cloth kind);
/// A head unrolled: u the azimuth (the face at 0.5), v from crown to chin.
Canvas paint_head(Random random, int width, int height, const Colour& skin, const Colour& hair);

}  // namespace ydd::sim
