// SPDX-License-Identifier: Apache-2.0
#include "ydd/bags/bag.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "ydd/bags/byte_source.h"
#include "ydd/bags/chunked_bag.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

enum class BagKind { ros1, ros1_old, mcap, sqlite, packed, none };

BagKind kind_of_bag(const fs::path& path) {
  const Result<bags::BagFile> file = bags::BagFile::open(path);
  if (!file) return BagKind::none;
  const std::string start = file->read(0, std::min<std::uint64_t>(16, file->size())).value_or("");
  if (start.starts_with("#ROSBAG V2.0\n")) return BagKind::ros1;
  if (start.starts_with("#ROSBAG V") || start.starts_with("#ROSRECORD V")) return BagKind::ros1_old;
  if (start.starts_with("\x89MCAP0\r\n")) return BagKind::mcap;
  if (start.starts_with("SQLite format 3")) return BagKind::sqlite;
  const std::string name = path.filename().string();
  const bool is_packed =
      bags::is_zstd(start) && (name.ends_with(".db3.zstd") || name.ends_with(".mcap.zstd"));
  return is_packed ? BagKind::packed : BagKind::none;
}

/// The files of a bag of ROS 2, which are numbered: "name_0.db3", "name_1.db3".
std::vector<fs::path> files_of_folder(const fs::path& folder) {
  std::vector<std::pair<long, fs::path>> files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    if (kind_of_bag(entry.path()) == BagKind::none) continue;
    const std::string name = entry.path().filename().string();
    const std::string stem = name.substr(0, name.find('.'));
    long number = 0;
    const char* const digits = stem.data() + stem.rfind('_') + 1;
    std::from_chars(digits, stem.data() + stem.size(), number);
    files.emplace_back(number, entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<fs::path> out;
  for (auto& [number, file] : files) out.push_back(std::move(file));
  return out;
}

/// Several files as one bag.
class BagOfFiles : public Bag {
 public:
  void add(const fs::path& file, std::shared_ptr<const Bag> bag) {
    std::vector<std::uint32_t> topic_of;
    for (const BagTopic& topic : bag->topics()) topic_of.push_back(merged(topic));
    for (const BagMessage& message : bag->messages()) {
      inner_.push_back({static_cast<std::uint32_t>(bags_.size()), message});
      messages_.push_back(message);
      messages_.back().topic = topic_of[message.topic];
      messages_.back().offset = inner_.size() - 1;
    }
    if (!bag->incomplete().empty()) {
      incomplete_ += fmt::format("{}{} {}", incomplete_.empty() ? "" : ", ",
                                 file.filename().string(), bag->incomplete());
    }
    notes_.insert(bag->notes().begin(), bag->notes().end());
    bags_.push_back(std::move(bag));
  }

  Result<std::string> read(const BagMessage& message) const override {
    const Inner& inner = inner_.at(message.offset);
    return bags_[inner.bag]->read(inner.message);
  }

 private:
  std::uint32_t merged(const BagTopic& topic) {
    for (std::uint32_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].name != topic.name || topics_[i].type != topic.type) continue;
      topics_[i].messages += topic.messages;
      return i;
    }
    topics_.push_back(topic);
    return static_cast<std::uint32_t>(topics_.size() - 1);
  }

  struct Inner {
    std::uint32_t bag = 0;
    BagMessage message;
  };
  std::vector<std::shared_ptr<const Bag>> bags_;
  std::vector<Inner> inner_;
};

Result<std::shared_ptr<const Bag>> open_bag_file(const fs::path& path) {
  switch (kind_of_bag(path)) {
    case BagKind::ros1:
      return bags::open_ros1_bag(path);
    case BagKind::mcap:
      return bags::open_mcap_bag(path);
    case BagKind::sqlite:
      return bags::open_sqlite_bag(path);
    case BagKind::ros1_old:
      return Error{fmt::format("{}: is a bag of an old format; 'rosbag fix' makes a new one of it",
                               path.string())};
    case BagKind::packed:
      return Error{
          fmt::format("{}: is packed as a whole; unpack it first (zstd -d)", path.string())};
    case BagKind::none:
      break;
  }
  return Error{fmt::format("{}: is no bag of ROS 1 or 2 (.bag, .db3, .mcap)", path.string())};
}

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code failure;
  if (!fs::is_directory(path, failure)) return kind_of_bag(path) != BagKind::none;
  return fs::exists(path / "metadata.yaml", failure) && !files_of_folder(path).empty();
}

Result<std::shared_ptr<const Bag>> open_bag(const fs::path& path) {
  std::error_code failure;
  if (!fs::is_directory(path, failure)) return open_bag_file(path);
  const std::vector<fs::path> files = files_of_folder(path);
  if (files.empty()) {
    return Error{fmt::format("{}: holds no bag of ROS 2 (.db3, .mcap)", path.string())};
  }
  if (files.size() == 1) return open_bag_file(files.front());
  const auto all = std::make_shared<BagOfFiles>();
  for (const fs::path& file : files) {
    Result<std::shared_ptr<const Bag>> bag = open_bag_file(file);
    if (!bag) return bag.error();
    all->add(file, *std::move(bag));
  }
  return std::shared_ptr<const Bag>(all);
}

}  // namespace ydd
