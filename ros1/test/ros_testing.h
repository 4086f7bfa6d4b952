// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <opencv2/imgcodecs.hpp>

/// A roscore, programs and a camera for tests of the node. C++17, like everything near ROS 1.
namespace ydd::ros1_testing {

namespace fs = std::filesystem;

/// Asks every few milliseconds; false when it does not come true in time.
inline bool wait_for(const std::function<bool()>& true_now, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (true_now()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true_now();
}

inline std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A folder that goes with the value.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "ydd-ros1-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// A program of one's own, ended with the value. Its output is in a file.
class Program {
 public:
  Program(std::vector<std::string> arguments, std::string output) : output_(std::move(output)) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    child_ = ::fork();
    if (child_ < 0) throw std::runtime_error("fork failed");
    if (child_ > 0) return;
    const int file = ::open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || ::dup2(file, 1) < 0 || ::dup2(file, 2) < 0) ::_exit(126);
    ::execvp(argv.front(), argv.data());
    ::_exit(127);
  }
  ~Program() {
    if (child_ > 0) end();
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// SIGINT, as Ctrl-C; SIGKILL when it does not go.
  int end() {
    ::kill(child_, SIGINT);
    return wait(20);
  }
  /// Its exit code, 128 + signal, or -1 when it had to be killed.
  int wait(double seconds) {
    int status = 0;
    const bool gone =
        wait_for([&] { return ::waitpid(child_, &status, WNOHANG) == child_; }, seconds);
    if (!gone) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, &status, 0);
    }
    child_ = -1;
    if (!gone) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string output() const { return text_of(output_); }

 private:
  std::string output_;
  pid_t child_ = -1;
};

/// A port that nobody listens on now.
inline int free_port() {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  const bool bound = ::bind(fd, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  ::close(fd);
  if (!bound) throw std::runtime_error("no port");
  return ntohs(address.sin_port);
}

inline bool on_path(const std::string& program) {
  std::istringstream folders(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// A master on a port of its own, and this process as a node. Once per process.
class Core {
 public:
  Core() {
    const std::string port = std::to_string(free_port());
    ::setenv("ROS_MASTER_URI", ("http://localhost:" + port).c_str(), 1);
    ::setenv("ROS_HOSTNAME", "localhost", 1);
    ::setenv("ROS_HOME", (folder_ / "ros").c_str(), 1);
    ::setenv("ROS_LOG_DIR", (folder_ / "log").c_str(), 1);
    ::unsetenv("ROS_IP");
    core_ = std::make_unique<Program>(std::vector<std::string>{"roscore", "-p", port},
                                      folder_ / "roscore.txt");
    ros::init(ros::M_string(), "ydd_slam_test", ros::init_options::NoSigintHandler);
    if (!wait_for([] { return ros::master::check(); }, 60)) {
      throw std::runtime_error("roscore does not answer: " + core_->output());
    }
    ros::start();
  }
  ~Core() { ros::shutdown(); }
  std::string operator/(const std::string& name) const { return folder_ / name; }

 private:
  Folder folder_;
  std::unique_ptr<Program> core_;
};

/// A recording in the TUM layout as messages; depth is stored as millimetres.
class Recording {
 public:
  explicit Recording(fs::path folder) : folder_(std::move(folder)) {
    colour_ = list_of("rgb.txt");
    depth_ = list_of("depth.txt");
    std::ifstream camera(folder_ / "camera.yaml");
    for (std::string line; std::getline(camera, line);) {
      const auto colon = line.find(':');
      if (colon != std::string::npos) {
        camera_[line.substr(0, colon)] = std::strtod(line.c_str() + colon + 1, nullptr);
      }
    }
  }
  std::size_t size() const { return colour_.size(); }

  sensor_msgs::Image colour(std::size_t i) const {
    const cv::Mat image = cv::imread((folder_ / colour_[i].second).string(), cv::IMREAD_COLOR);
    return message(colour_[i].first, image, "bgr8", 3);
  }
  sensor_msgs::Image depth(std::size_t i) const {
    const cv::Mat image = cv::imread((folder_ / depth_[i].second).string(), cv::IMREAD_UNCHANGED);
    return message(colour_[i].first, image, "16UC1", 2);
  }
  sensor_msgs::CameraInfo info(std::size_t i) const {
    sensor_msgs::CameraInfo out;
    out.header = header(colour_[i].first);
    out.width = static_cast<std::uint32_t>(camera_.at("width"));
    out.height = static_cast<std::uint32_t>(camera_.at("height"));
    out.distortion_model = "plumb_bob";
    out.D.assign(5, 0.0);
    out.K = {camera_.at("fx"), 0, camera_.at("cx"), 0, camera_.at("fy"), camera_.at("cy"), 0, 0, 1};
    return out;
  }

 private:
  std::vector<std::pair<std::string, std::string>> list_of(const char* name) const {
    std::vector<std::pair<std::string, std::string>> out;
    std::ifstream in(folder_ / name);
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::string stamp, file;
      if (line.rfind('#', 0) != 0 && words >> stamp >> file) out.emplace_back(stamp, file);
    }
    return out;
  }
  static std_msgs::Header header(const std::string& stamp) {
    std_msgs::Header out;
    out.frame_id = "camera_optical";
    const auto point = stamp.find('.');
    std::string fraction = point == std::string::npos ? "" : stamp.substr(point + 1);
    fraction.resize(9, '0');
    out.stamp = ros::Time(static_cast<std::uint32_t>(std::stoul(stamp)),
                          static_cast<std::uint32_t>(std::stoul(fraction)));
    return out;
  }
  static sensor_msgs::Image message(const std::string& stamp, const cv::Mat& image,
                                    const char* encoding, int bytes) {
    sensor_msgs::Image out;
    out.header = header(stamp);
    out.width = static_cast<std::uint32_t>(image.cols);
    out.height = static_cast<std::uint32_t>(image.rows);
    out.encoding = encoding;
    out.step = out.width * static_cast<std::uint32_t>(bytes);
    out.data.assign(image.data, image.data + std::size_t{out.step} * out.height);
    return out;
  }

  fs::path folder_;
  std::vector<std::pair<std::string, std::string>> colour_, depth_;
  std::map<std::string, double> camera_;
};

/// Publishes what a driver would.
class CameraDriver {
 public:
  CameraDriver()
      : colour_(node_.advertise<sensor_msgs::Image>("colour/image", 30)),
        depth_(node_.advertise<sensor_msgs::Image>("depth/image", 30)),
        info_(node_.advertise<sensor_msgs::CameraInfo>("colour/camera_info", 30)) {}

  bool somebody_listens() const {
    return wait_for(
        [&] {
          return colour_.getNumSubscribers() > 0 && depth_.getNumSubscribers() > 0 &&
                 info_.getNumSubscribers() > 0;
        },
        30);
  }
  void publish(const sensor_msgs::Image& colour, const sensor_msgs::Image& depth,
               const sensor_msgs::CameraInfo& info) {
    info_.publish(info);
    depth_.publish(depth);
    colour_.publish(colour);
  }
  /// Frames [first, last) at 30 Hz.
  void play(const Recording& recording, std::size_t first, std::size_t last) {
    auto due = std::chrono::steady_clock::now();
    for (std::size_t i = first; i < last; ++i) {
      const auto colour = recording.colour(i);
      const auto depth = recording.depth(i);
      std::this_thread::sleep_until(due);
      publish(colour, depth, recording.info(i));
      due += std::chrono::milliseconds(33);
    }
  }

 private:
  ros::NodeHandle node_;
  ros::Publisher colour_, depth_, info_;
};

/// What image_transport would publish.
class PackedDriver {
 public:
  PackedDriver()
      : colour_(node_.advertise<sensor_msgs::CompressedImage>("colour/image/compressed", 30)),
        depth_(node_.advertise<sensor_msgs::CompressedImage>("depth/image/compressedDepth", 30)),
        info_(node_.advertise<sensor_msgs::CameraInfo>("colour/camera_info", 30)) {}
  bool somebody_listens() const {
    return wait_for(
        [&] { return colour_.getNumSubscribers() > 0 && depth_.getNumSubscribers() > 0; }, 30);
  }
  void publish(const Recording& recording, std::size_t i) {
    info_.publish(recording.info(i));
    const sensor_msgs::Image colour = recording.colour(i), depth = recording.depth(i);
    depth_.publish(packed(depth, CV_16UC1, ".png", "16UC1; compressedDepth png", 12));
    colour_.publish(packed(colour, CV_8UC3, ".jpg", "bgr8; jpeg compressed bgr8", 0));
  }

 private:
  static sensor_msgs::CompressedImage packed(const sensor_msgs::Image& image, int type,
                                             const char* ending, const char* format,
                                             std::size_t head) {
    const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), type,
                         const_cast<std::uint8_t*>(image.data.data()));
    std::vector<std::uint8_t> bytes;
    cv::imencode(ending, pixels, bytes);
    sensor_msgs::CompressedImage out;
    out.header = image.header;
    out.format = format;
    out.data.assign(head, 0);
    out.data.insert(out.data.end(), bytes.begin(), bytes.end());
    return out;
  }
  ros::NodeHandle node_;
  ros::Publisher colour_, depth_, info_;
};

/// All messages of a topic.
template <class Message>
class Heard {
 public:
  explicit Heard(const std::string& topic)
      : subscriber_(node_.subscribe<Message>(topic, 200, &Heard::take, this)) {}

  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return all_.size();
  }
  std::vector<Message> all() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return all_;
  }
  Message last() const { return all().back(); }
  /// Whether what is published now would be heard.
  bool connected() const {
    return wait_for([&] { return subscriber_.getNumPublishers() > 0; }, 30);
  }

 private:
  void take(const boost::shared_ptr<const Message>& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    all_.push_back(*message);
  }
  mutable std::mutex mutex_;
  std::vector<Message> all_;
  ros::NodeHandle node_;
  ros::Subscriber subscriber_;
};

}  // namespace ydd::ros1_testing
