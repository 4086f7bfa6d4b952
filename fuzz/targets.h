// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// One function for each parser: it must come back, whatever the input says. What is wrong shows as
/// a report of a sanitizer, as an exception that nobody expects, or as broken().
namespace ydd::fuzz {

void bag_mcap(std::string_view input);
void bag_ros1(std::string_view input);
void bag_sqlite(std::string_view input);
void camera(std::string_view input);
void class_table(std::string_view input);
void detections(std::string_view input);
void detector(std::string_view input);
void http(std::string_view input);
void jpeg(std::string_view input);
void json(std::string_view input);
void layouts(std::string_view input);
void live_text(std::string_view input);
void map_blobs(std::string_view input);
void map_file(std::string_view input);
void map_rows(std::string_view input);
void objects(std::string_view input);
void onnx(std::string_view input);
void options(std::string_view input);
void paper_run(std::string_view input);
void png(std::string_view input);
void png_pixels(std::string_view input);
void ros_messages(std::string_view input);
void sens(std::string_view input);
void sensor_image(std::string_view input);
void sequence(std::string_view input);
void trajectory(std::string_view input);
void yaml(std::string_view input);

}  // namespace ydd::fuzz
