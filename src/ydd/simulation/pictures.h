// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/simulation/canvas.h"

/// Painted things that hang, stand or lie in an office. Sizes in texels.
namespace ydd::sim {

/// A photo-like landscape, a text sheet, a chart, a map, a mosaic or a print of shapes, by chance.
Canvas paint_poster(Random random, int width, int height);
/// A desktop with windows of text, pictures and a task bar.
Canvas paint_screen(Random random, int width, int height);
Canvas paint_keyboard(Random random, int width, int height);
/// The back of a book as it stands on a shelf.
Canvas paint_spine(Random random, int width, int height);
/// The cover of a book or a magazine.
Canvas paint_cover(Random random, int width, int height);
/// A white board with handwriting and diagrams.
Canvas paint_whiteboard(Random random, int width, int height);
/// Cork with notes pinned all over.
Canvas paint_pinboard(Random random, int width, int height);
/// A printed mug, unrolled.
Canvas paint_mug(Random random, int width, int height);
/// Window: sky, houses, frame.
Canvas paint_window(Random random, int width, int height);
/// Door with panels.
Canvas paint_door(Random random, int width, int height);

}  // namespace ydd::sim
