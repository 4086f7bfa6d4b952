// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/dataset/camera_file.h"

namespace ydd::fuzz {

void camera(std::string_view input) {
  const Result<Camera> camera = load_camera(file_of(input, "camera.yaml"));
  expect_one_line(camera);
  if (camera && !check_camera(*camera)) broken("a camera that cannot be");
}

}  // namespace ydd::fuzz
