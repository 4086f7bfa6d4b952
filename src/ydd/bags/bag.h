// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/messages/wire_reader.h"

/// Files of recorded messages: bags of ROS 1 (ros1_bag.cc), of ROS 2 in SQLite (sqlite_bag.cc) and
/// in MCAP (mcap_bag.cc). A bag is looked through once when it is opened; messages are read when
/// they are wanted, so that memory holds the index and a chunk, however long the bag is.
namespace ydd {

/// A topic of a bag and what is on it.
struct BagTopic {
  std::string name;  ///< "/camera/depth/image_raw"
  std::string type;  ///< "sensor_msgs/Image", "sensor_msgs/msg/Image"
  Wire wire = Wire::ros1;
  std::size_t messages = 0;
};

/// Where a message is.
struct BagMessage {
  std::uint32_t topic = 0;  ///< of Bag::topics
  std::uint32_t part = 0;   ///< of what the bag is made of: chunk or file; kNoPart: itself
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  Timestamp received;
  Timestamp stamp;  ///< of the message's header

  static constexpr std::uint32_t kNoPart = ~std::uint32_t{0};
};

/// Immutable; any thread may read.
class Bag {
 public:
  Bag() = default;
  virtual ~Bag() = default;
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;

  /// All of them.
  const std::vector<BagTopic>& topics() const { return topics_; }
  /// Those of kinds that are read (message_kind), in the order of the file.
  const std::vector<BagMessage>& messages() const { return messages_; }
  /// Names and texts that its recorder left in it, by the name of what they are about (metadata of
  /// MCAP).
  using Notes = std::map<std::string, std::map<std::string, std::string>>;
  const Notes& notes() const { return notes_; }
  /// Why it was read in part only: "is cut off at byte 12". Empty: it is whole.
  const std::string& incomplete() const { return incomplete_; }

  /// The bytes of a message.
  virtual Result<std::string> read(const BagMessage& message) const = 0;

 protected:
  std::vector<BagTopic> topics_;
  std::vector<BagMessage> messages_;
  Notes notes_;
  std::string incomplete_;
};

/// Whether `path` is a bag by its first bytes, or a folder of one (metadata.yaml of ROS 2).
bool is_bag(const std::filesystem::path& path);

/// Opens a bag, or the folder of one in several files. A bag that ends in the middle, or is damaged
/// there, is read up to that place; `incomplete` tells it. Fails when nothing can be read.
Result<std::shared_ptr<const Bag>> open_bag(const std::filesystem::path& path);

}  // namespace ydd
