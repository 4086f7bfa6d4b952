// SPDX-License-Identifier: Apache-2.0
#include "bag_reading.h"
#include "targets.h"

namespace ydd::fuzz {

// A byte for kind and wire, then a message.
void ros_messages(std::string_view input) {
  Pieces pieces(input);
  const std::uint8_t choice = pieces.byte();
  const MessageKind kind = choice % 3 == 0   ? MessageKind::image
                           : choice % 3 == 1 ? MessageKind::compressed_image
                                             : MessageKind::camera_info;
  const Wire wire = choice & 0x80U ? Wire::cdr : Wire::ros1;
  const std::string_view bytes = pieces.text(input.size());
  static_cast<void>(header_stamp(bytes, wire));
  read_as_anything({"a message", kind, wire, std::make_shared<const std::string>(bytes)});
}

}  // namespace ydd::fuzz
